#pragma once
// A loop over chunks on several threads. Which thread takes which chunk is left to chance, so callers keep their results per chunk
// (or add integers) and never depend on it.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace equilux {

inline unsigned thread_count(unsigned wanted, std::size_t chunks) {
  const unsigned available = wanted != 0 ? wanted : std::max(1u, std::thread::hardware_concurrency());
  return static_cast<unsigned>(std::clamp<std::size_t>(chunks, 1, available));
}

/// Calls body(chunk, thread) for every chunk in [0, chunks); the first exception of any thread is thrown again here.
template <class Body>
void parallel_chunks(std::size_t chunks, unsigned threads, Body&& body) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_lock;
  const auto work = [&](unsigned thread) {
    try {
      for (std::size_t chunk = next++; chunk < chunks; chunk = next++) body(chunk, thread);
    } catch (...) {
      const std::lock_guard guard(failure_lock);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned thread = 1; thread < threads; ++thread) others.emplace_back(work, thread);
    work(0);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace equilux
