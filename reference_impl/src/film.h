// Threads over samples. Each sample is computed on its own, so the picture does not depend on how many threads there are.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace equilux {

// Set from any thread; looked at before every chunk.
class Cancel {
 public:
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> cancelled_{false};
};

// The caller's wish to stop that is not a Cancel: a pending KeyboardInterrupt. Asked about twenty times a second, on the calling thread.
using Interrupted = std::function<bool()>;

// Asked now and then by work that may take long over one sample: true if it is to give up.
using Stopped = std::function<bool()>;

// Calls work(begin, end, stopped) for chunks of [0, count) on `threads` threads (0: one per core). Returns false if cancelled or interrupted before
// the end. The first exception that work throws is thrown again here.
bool for_each_chunk(std::size_t count, int threads, const Cancel* cancel, const Interrupted& interrupted,
                    const std::function<void(std::size_t, std::size_t, const Stopped&)>& work);

// The same for work(begin, end) that is never long over a sample.
inline bool for_each_chunk(std::size_t count, int threads, const Cancel* cancel, const Interrupted& interrupted,
                           const std::function<void(std::size_t, std::size_t)>& work) {
  return for_each_chunk(count, threads, cancel, interrupted,
                        [&work](std::size_t begin, std::size_t end, const Stopped&) { work(begin, end); });
}

}  // namespace equilux
