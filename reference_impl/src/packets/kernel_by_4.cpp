#include "kernel_packets.h"

namespace equilux::packets {

Kernel kernel_by_4(const Needs& needs) { return chosen_kernel<4>(needs); }

}  // namespace equilux::packets
