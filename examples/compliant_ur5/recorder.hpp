// The main job's run as a file, and what viewers are told of it.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "examples/compliant_ur5/run_log.hpp"
#include "examples/compliant_ur5/settings.hpp"
#include "examples/support/job.hpp"
#include "skinctl/recording/mcap_recorder.hpp"

namespace compliant_ur5 {

/// Joints, frames, cells, robot and skin of the job, for files and streams.
skinctl::RunDescription run_description(const Settings& settings);

/// The scene in words: every setting that a command depends on, and the skin file's contents. Recordings of
/// another scene are refused.
skinctl::RunIdentity run_identity(const Settings& settings);

/// Hands the cycles of a run to a file, if the settings ask for one, and to others. Without any it does
/// nothing.
template <class Scene>
class JobRecorder {
 public:
  using Consumers = std::vector<skinctl::CycleConsumer<Scene>*>;

  /// Throws `skinctl::ConfigurationError` where the file cannot be made.
  explicit JobRecorder(const Settings& s, Consumers consumers = {})
      : patient_(!s.robot && s.speed == 0), path_(s.record) {
    if (!s.record.empty()) {
      file_ = std::make_unique<skinctl::McapRecorder<Scene>>(s.record, run_identity(s), run_description(s));
      consumers.push_back(file_.get());
    }
    if (!consumers.empty()) thread_ = std::make_unique<skinctl::CycleThread<Scene>>(std::move(consumers));
  }
  template <class... Begin>
  void start(const Begin&... begin) noexcept {
    if (thread_) thread_->start(begin...);
  }
  template <class Watch>
  void operator()(const typename Scene::Input& input, const typename Scene::Output& out, const Watch& watch) {
    if (!thread_) return;
    (*thread_)(input, out, watch);
    if (patient_) thread_->wait();  // simulated time waits for the disk
  }
  /// After the run: ends the file, and says what of the run did not get into it.
  void finish(RunLog& log) {
    if (!thread_) return;
    thread_->finish();
    const auto dropped = thread_->dropped();
    if (dropped > 0) log.result.push_back({"cycles that were not recorded or sent", std::to_string(dropped)});
    if (!file_) return;
    const bool whole = file_->finish();
    if (!whole)
      std::fprintf(stderr,
                   "%s is not whole: %llu cycles found no room, %llu messages were refused by the disk\n",
                   path_.c_str(), static_cast<unsigned long long>(dropped),
                   static_cast<unsigned long long>(file_->lost()));
  }

 private:
  bool patient_;
  std::string path_;
  std::unique_ptr<skinctl::McapRecorder<Scene>> file_;
  std::unique_ptr<skinctl::CycleThread<Scene>> thread_;
};

}  // namespace compliant_ur5
