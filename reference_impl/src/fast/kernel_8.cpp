// Packets of 8: AVX2 and FMA, compiled with flags of this file's own (CMakeLists.txt).
#include "kernel.h"

#if defined(__AVX2__) && defined(__FMA__)
#include "render_packets.h"

namespace equilux::fast {
const Kernels* kernels_of_8() { return kernels<8>(); }
}  // namespace equilux::fast
#else
namespace equilux::fast {
const Kernels* kernels_of_8() { return nullptr; }
}  // namespace equilux::fast
#endif
