// How the processor treats numbers too small for a float's exponent.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace equilux::fast {

// Numbers below 1e-38 count as 0 while this lives: they would cost a hundred times as much, and Embree asks for it.
class FlushedToZero {
 public:
#if defined(__SSE2__)
  FlushedToZero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040); }
  ~FlushedToZero() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#else
  FlushedToZero() {}
  ~FlushedToZero() {}
#endif
};

}  // namespace equilux::fast
