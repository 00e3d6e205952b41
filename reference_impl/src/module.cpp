#include <nanobind/nanobind.h>
#if EQUILUX_EMBREE_MAJOR == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif
NB_MODULE(_tracer, m) { m.doc() = "The exact Phong tracer of equilux."; m.attr("embree_version") = RTC_VERSION_STRING; }
