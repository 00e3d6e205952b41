#include "film.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace equilux {
namespace {

constexpr std::size_t chunk_size = 256;

// What the threads of one call share.
struct Pool {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::condition_variable finished;
  int running = 0;
  std::exception_ptr failure;
};

using Work = std::function<void(std::size_t, std::size_t, const Stopped&)>;

void work_through(Pool& pool, std::size_t count, const Cancel* cancel, const Work& work) {
  const Stopped stopped = [&] { return pool.stop.load(std::memory_order_relaxed) || (cancel != nullptr && cancel->cancelled()); };
  try {
    while (!pool.stop.load(std::memory_order_relaxed)) {
      if (cancel != nullptr && cancel->cancelled()) pool.stop = true;
      const std::size_t begin = pool.next.fetch_add(chunk_size);
      if (begin >= count || pool.stop) break;
      work(begin, std::min(begin + chunk_size, count), stopped);
    }
  } catch (...) {
    const std::lock_guard lock(pool.mutex);
    if (!pool.failure) pool.failure = std::current_exception();
    pool.stop = true;
  }
  const std::lock_guard lock(pool.mutex);
  --pool.running;
  pool.finished.notify_one();
}

}  // namespace

bool for_each_chunk(std::size_t count, int threads, const Cancel* cancel, const Interrupted& interrupted,
                    const Work& work) {
  const std::size_t chunks = (count + chunk_size - 1) / chunk_size;
  const std::size_t cores = threads > 0 ? static_cast<std::size_t>(threads) : std::max(1u, std::thread::hardware_concurrency());
  const std::size_t workers = std::min(cores, chunks);
  const auto stopped = [cancel] { return cancel != nullptr && cancel->cancelled(); };

  if (chunks <= 1) {  // a handful of samples is done before a thread would have started
    bool interrupt = false;  // the thread that may ask Python is this one
    const Stopped given_up = [&] { return interrupt = interrupt || stopped() || (interrupted && interrupted()); };
    if (!stopped() && count > 0) work(0, count, given_up);
    return !interrupt && !stopped();
  }

  Pool pool;
  pool.running = static_cast<int>(workers);
  std::vector<std::thread> crew;
  crew.reserve(workers);
  for (std::size_t i = 0; i < workers; ++i) {
    try {
      crew.emplace_back([&] { work_through(pool, count, cancel, work); });
    } catch (const std::system_error&) {  // no more threads to be had: those that run do it all
      const std::lock_guard lock(pool.mutex);
      --pool.running;
    }
  }
  if (crew.empty()) {
    pool.running = 1;
    work_through(pool, count, cancel, work);
  }

  // The calling thread watches: it alone may ask Python whether Ctrl-C was pressed.
  bool interrupt = false;
  {
    std::unique_lock lock(pool.mutex);
    while (!pool.finished.wait_for(lock, std::chrono::milliseconds(50), [&] { return pool.running == 0; })) {
      lock.unlock();
      if (!interrupt && interrupted && interrupted()) {
        interrupt = true;
        pool.stop = true;
      }
      lock.lock();
    }
  }
  for (std::thread& thread : crew) thread.join();
  if (pool.failure) std::rethrow_exception(pool.failure);
  return !interrupt && !stopped();
}

}  // namespace equilux
