#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace trochoid {

/// Threads that share the parts of one piece of work. Which thread takes a part never shows in the result, as parts write apart from
/// each other. One owner at a time: run() is not to be called from two threads, nor from within a part.
class Workers {
public:
    /// `threads` in all, the caller of run() included; 0 takes as many as the machine has cores, 1 starts none.
    explicit Workers(unsigned threads = 1);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    unsigned threads() const { return static_cast<unsigned>(pool_.size()) + 1; }
    /// Calls work(part, thread) for every part in [0, parts), each once; thread is in [0, threads()). Returns when all are done. An
    /// exception of a part ends the run after the parts under way, and is thrown again here.
    void run(size_t parts, const std::function<void(size_t part, unsigned thread)>& work);

private:
    void serve(const std::stop_token& stop, unsigned thread);
    void take_parts(unsigned thread);

    std::mutex mutex_;
    std::condition_variable_any changed_;
    const std::function<void(size_t, unsigned)>* work_ = nullptr;
    size_t parts_ = 0;
    size_t next_ = 0;
    unsigned busy_ = 0;
    uint64_t round_ = 0;
    std::exception_ptr failure_;
    std::vector<std::jthread> pool_;
};

}  // namespace trochoid
