#include "kernel_packets.h"

namespace equilux::packets {

Kernel kernel_by_8(const Needs& needs) { return chosen_kernel<8>(needs); }

}  // namespace equilux::packets
