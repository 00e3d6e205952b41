#include "kernel_packets.h"

namespace equilux::packets {

Kernel kernel_by_2(const Needs& needs) { return chosen_kernel<2>(needs); }

}  // namespace equilux::packets
