// One RTDE client as the controller sees it: negotiation, recipes, start and pause, data. Without sockets.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "examples/simulated_ur5/controller.hpp"
#include "examples/simulated_ur5/random.hpp"
#include "examples/simulated_ur5/rtde.hpp"

namespace simulated_ur5::rtde {

/// Which session holds which input: one client per variable.
class InputOwners {
 public:
  InputOwners() : owner_(input_key_count(), nullptr) {}
  /// False if another session holds it.
  bool free_for(std::size_t key, const void* session) const { return !owner_[key] || owner_[key] == session; }
  void take(std::size_t key, const void* session) { owner_[key] = session; }
  void release(const void* session) {
    for (const void*& o : owner_)
      if (o == session) o = nullptr;
  }

 private:
  std::vector<const void*> owner_;
};

/// How far a server goes in annoying its clients, all of it within what real controllers do.
struct Quirks {
  bool data_before_start_reply = false;  ///< the first data package overtakes the reply to S
  double skipped_outputs = 0;  ///< share of data packages that a busy controller leaves out, 0 to 0.9
};

/// A client's connection. Version 1 until the client asks for 2, as on a real controller.
class Session {
 public:
  Session(Controller& controller, InputOwners& owners, const Quirks& quirks, std::uint64_t seed);
  ~Session() { owners_.release(this); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Takes received bytes, appends replies to `out`. False: the client does not speak RTDE, close the
  /// connection (after sending `out`, which says why).
  bool receive(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& out);

  /// To be called once per control cycle; appends a data package when one is due and returns true then.
  /// @param late  the controller is behind its clock: outputs are skipped, never sent late.
  bool publish(std::vector<std::uint8_t>& out, bool late);

  bool started() const { return started_; }
  bool unfinished() const { return framer_.unfinished(); }
  int version() const { return version_; }
  int divider() const { return divider_; }

 private:
  struct InputRecipe {
    std::vector<Input> inputs;
    std::size_t size = 0;
    Controller::InputEffects effects;
    std::vector<std::string> names;
  };
  bool handle(const Framer::Frame& frame, std::vector<std::uint8_t>& out);
  void setup_outputs(BigEndianReader& in, std::vector<std::uint8_t>& out);
  void setup_inputs(BigEndianReader& in, std::vector<std::uint8_t>& out);
  void take_data(BigEndianReader& in, std::vector<std::uint8_t>& out);
  void write_data(std::vector<std::uint8_t>& out) const;
  void complain(std::vector<std::uint8_t>& out, Level level, const std::string& text) const;

  Controller& controller_;
  InputOwners& owners_;
  Quirks quirks_;
  Random random_;
  Framer framer_;
  int version_ = 1;
  bool started_ = false;
  std::vector<Output> outputs_;
  int divider_ = 1, until_next_ = 0;
  std::vector<InputRecipe> inputs_;  ///< recipe id - 1
};

}  // namespace simulated_ur5::rtde
