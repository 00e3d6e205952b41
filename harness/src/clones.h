#pragma once
// EQUILUX_CLONES before a function: compiled once per generation of SIMD, the widest that the machine has is taken when the program
// starts. Contraction is off everywhere, so all of them give the same bits.

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__linux__)
#define EQUILUX_CLONES [[gnu::target_clones("avx512f", "avx2", "default")]]
#else
#define EQUILUX_CLONES
#endif
