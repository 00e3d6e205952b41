#include <nanobind/nanobind.h>
NB_MODULE(_compare, m) { m.doc() = "Comparison kernel of equilux."; }
