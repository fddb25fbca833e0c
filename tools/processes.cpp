#include "processes.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <tufa/error.h>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <utility>
#include <vector>

#include "console.h"

namespace tufa::tools {
namespace {

/// A process at work.
struct Worker {
  std::size_t index = 0;
  pid_t process = 0;
  int pipe = -1;
  std::string output;
};

[[noreturn]] void failToStart(const char* what) {
  throw Error(ErrorCode::LimitExceeded,
              std::string("no process can be started: ") + what + ": " + std::strerror(errno));
}

bool writeAll(int descriptor, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

/// What a process does from its first moment to its end.
[[noreturn]] void workAndEnd(int pipe, pid_t parent, std::size_t index,
                             const std::function<std::string(std::size_t)>& work) {
  // It must not outlive who waits for it.
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  bool written = ::getppid() == parent;
  try {
    written = written && writeAll(pipe, work(index));
  } catch (const std::exception& error) {
    printNote(error.what());
    written = false;
  }
  endAtOnce(written ? 0 : 1);
}

class Pool {
 public:
  Pool(const std::function<std::string(std::size_t)>& work,
       const std::function<bool(std::size_t, const ProcessResult&)>& done)
      : work_(work), done_(done) {}
  ~Pool() {
    // Only where something was thrown are there any left.
    stopAll();
    for (const Worker& worker : workers_) {
      ::close(worker.pipe);
      while (::waitpid(worker.process, nullptr, 0) < 0 && errno == EINTR) continue;
    }
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  void run(std::size_t count, std::size_t jobs) {
    std::size_t next = 0;
    while (true) {
      while (goOn_ && !interrupted() && next < count && workers_.size() < jobs) start(next++);
      if (workers_.empty()) break;
      if (interrupted() && !std::exchange(stopped_, true)) stopAll();
      readSome();
      tellInOrder();
    }
    stopIfAsked();
  }

 private:
  void start(std::size_t index) {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) failToStart("no pipe");
    const pid_t parent = ::getpid();
    std::fflush(nullptr);
    const pid_t process = ::fork();
    if (process < 0) {
      ::close(ends[0]);
      ::close(ends[1]);
      failToStart("fork");
    }
    if (process == 0) {
      ::close(ends[0]);
      workAndEnd(ends[1], parent, index, work_);
    }
    ::close(ends[1]);
    workers_.push_back({index, process, ends[0], {}});
  }

  void stopAll() {
    for (const Worker& worker : workers_) ::kill(worker.process, SIGTERM);
  }

  /// Reads what has come, and parts with those that have ended.
  void readSome() {
    std::vector<pollfd> pipes;
    for (const Worker& worker : workers_) pipes.push_back({worker.pipe, POLLIN, 0});
    constexpr int kMilliseconds = 200;
    if (::poll(pipes.data(), pipes.size(), kMilliseconds) <= 0) return;
    for (std::size_t i = pipes.size(); i-- > 0;) {
      if (pipes[i].revents == 0) continue;
      std::array<char, 65536> bytes{};
      const ssize_t count = ::read(workers_[i].pipe, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count > 0) {
        workers_[i].output.append(bytes.data(), static_cast<std::size_t>(count));
      } else {
        finish(i);
      }
    }
  }

  void finish(std::size_t place) {
    Worker worker = std::move(workers_[place]);
    workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(place));
    ::close(worker.pipe);
    int status = 0;
    while (::waitpid(worker.process, &status, 0) < 0 && errno == EINTR) continue;
    results_[worker.index] = {std::move(worker.output), WIFSIGNALED(status) ? WTERMSIG(status) : 0};
  }

  void tellInOrder() {
    for (auto first = results_.begin(); first != results_.end() && first->first == told_;
         first = results_.erase(first), ++told_) {
      if (interrupted()) return;
      if (!done_(first->first, first->second)) goOn_ = false;
    }
  }

  const std::function<std::string(std::size_t)>& work_;
  const std::function<bool(std::size_t, const ProcessResult&)>& done_;
  std::vector<Worker> workers_;
  std::map<std::size_t, ProcessResult> results_;  ///< not told yet
  std::size_t told_ = 0;
  bool goOn_ = true;
  bool stopped_ = false;
};

}  // namespace

void runInProcesses(std::size_t count, int jobs,
                    const std::function<std::string(std::size_t index)>& work,
                    const std::function<bool(std::size_t index, const ProcessResult&)>& done) {
  Pool(work, done).run(count, static_cast<std::size_t>(jobs));
}

}  // namespace tufa::tools
