// Packets of 4: the instruction set that every machine of this architecture has.
#include "render_packets.h"

namespace equilux::fast {
const Kernels* kernels_of_4() { return kernels<4>(); }
}  // namespace equilux::fast
