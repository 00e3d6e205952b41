// Packets of 16: AVX-512, compiled with flags of this file's own (CMakeLists.txt).
#include "kernel.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#include "render_packets.h"

namespace equilux::fast {
const Kernels* kernels_of_16() { return kernels<16>(); }
}  // namespace equilux::fast
#else
namespace equilux::fast {
const Kernels* kernels_of_16() { return nullptr; }
}  // namespace equilux::fast
#endif
