// The Python class FloatMode.
#pragma once

#include <nanobind/nanobind.h>

namespace equilux::fast {

// finish: raises what stopped an incomplete picture.
void bind_float_mode(nanobind::module_& m, void (*finish)(bool complete));

}  // namespace equilux::fast
