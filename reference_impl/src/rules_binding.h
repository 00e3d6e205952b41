// Rules by name, as Python gives them.
#pragma once

#include <nanobind/nanobind.h>

#include "rules.h"

namespace equilux {

// Every field of Rules must be there, and nothing else. Raises TracerError with the field and what is allowed.
void set_rules(Rules& rules, const nanobind::kwargs& fields);

}  // namespace equilux
