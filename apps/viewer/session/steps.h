// steps.h: steps in time, models in files, read ahead by a thread of its own.
#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "session/scene_loader.h"

namespace vog::viewer {

/// Models of a sequence. Those around the wanted step are kept, the ones after it are read first.
class Steps {
  public:
    /// files  of one model each, in the order of time; at least one
    Steps(std::vector<std::string> files, ReadFiles read);
    ~Steps();
    Steps(const Steps&) = delete;
    Steps& operator=(const Steps&) = delete;

    std::size_t count() const { return files_.size(); }
    const std::string& file(std::size_t step) const { return files_[step]; }
    /// The step whose model is needed next.
    void want(std::size_t step);
    /// The model of a step, with its hierarchy; null: not read yet.
    /// throws  vog::Error for a file that could not be read
    std::shared_ptr<const Level> get(std::size_t step);
    /// Number of steps after the wanted one that are in memory, one after the other.
    std::size_t ahead();

  private:
    void work();
    std::size_t next_missing() const;
    void drop_others();
    Level read(std::size_t step) const;

    std::vector<std::string> files_;
    ReadFiles read_;
    std::mutex mutex_;  ///< guards the members below
    std::condition_variable wake_;
    std::map<std::size_t, std::shared_ptr<const Level>> kept_;
    std::map<std::size_t, std::string> errors_;
    std::size_t wanted_ = 0;
    bool end_ = false;
    std::thread thread_;
};

}  // namespace vog::viewer
