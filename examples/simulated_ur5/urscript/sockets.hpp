// The sockets that a program opens, as the program sees them; the network behind serves them between cycles.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace simulated_ur5::urscript {

struct Socket {
  enum class State { wanted, open, failed };
  std::uint64_t number = 0;  ///< tells this socket from others of the same name
  std::string name, host;
  std::uint16_t port = 0;
  State state = State::wanted;
  bool peer_gone = false;  ///< what came before can still be read
  std::vector<std::uint8_t> received, to_send;
};

/// All sockets of one program.
class Sockets {
 public:
  static constexpr std::size_t most = 16, longest_queue = 1 << 20;

  /// Null: there are too many, or an older one has this name.
  std::shared_ptr<Socket> open(std::string name, std::string host, std::uint16_t port) {
    if (all_.size() >= most || find(name)) return nullptr;
    auto s = std::make_shared<Socket>();
    s->number = ++count_;
    s->name = std::move(name);
    s->host = std::move(host);
    s->port = port;
    all_.push_back(s);
    return s;
  }
  std::shared_ptr<Socket> find(std::string_view name) const {
    const auto found = std::find_if(all_.begin(), all_.end(), [&](const auto& s) { return s->name == name; });
    return found == all_.end() ? nullptr : *found;
  }
  void close(std::string_view name) {
    std::erase_if(all_, [&](const auto& s) { return s->name == name; });
  }
  void close_all() { all_.clear(); }
  const std::vector<std::shared_ptr<Socket>>& all() const { return all_; }

 private:
  std::vector<std::shared_ptr<Socket>> all_;
  std::uint64_t count_ = 0;
};

}  // namespace simulated_ur5::urscript
