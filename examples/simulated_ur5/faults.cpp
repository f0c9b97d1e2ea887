#include "examples/simulated_ur5/faults.hpp"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <list>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace simulated_ur5 {
namespace {
constexpr std::size_t most_waiting = 1 << 20;  // bytes that are no whole package
}

/// One client and its connection to the target.
struct FaultyWire::Session {
  int program = -1, robot = -1;
  Bytes up, down;  ///< bytes of packages that are not whole yet
  struct Late {
    std::chrono::steady_clock::time_point due;
    bool from_robot;
    Bytes bytes;
  };
  std::list<Late> late;  ///< on their way, in order
  RtdeLayout layout;
  bool open = true;
  ~Session() { close(); }
  void close() {
    for (int* fd : {&program, &robot}) {
      if (*fd >= 0) ::close(*fd);
      *fd = -1;
    }
    open = false;
  }
};

struct FaultyWire::State {
  int listener = -1;
  std::list<Session> sessions;
  std::mutex mutex;
  Cable cable = Cable::whole;
  Change change;
  std::function<void(bool, bool)> observer;
  std::size_t piece = 0;
  int pause_ms = 0, delay_ms = 0;
  std::atomic<bool> end{false};
  std::thread thread;
};

namespace {

int connected(std::uint16_t port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return fd;
  ::close(fd);
  return -1;
}
void no_delay(int fd) {
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}
bool send_all(int fd, const Bytes& bytes, std::size_t piece, int pause_ms) {
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t n = piece == 0 ? bytes.size() - at : std::min(piece, bytes.size() - at);
    const auto sent = ::send(fd, bytes.data() + at, n, MSG_NOSIGNAL);
    if (sent <= 0) return false;
    at += static_cast<std::size_t>(sent);
    if (pause_ms > 0) std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
  }
  return true;
}

}  // namespace

FaultyWire::FaultyWire(std::uint16_t target, bool rtde, std::uint16_t listen)
    : target_(target), rtde_(rtde), state_(std::make_unique<State>()) {
  state_->listener = ::socket(AF_INET, SOCK_STREAM, 0);
  const int on = 1;
  ::setsockopt(state_->listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(listen);
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  if (::bind(state_->listener, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0 ||
      ::listen(state_->listener, 4) != 0 ||
      ::getsockname(state_->listener, reinterpret_cast<sockaddr*>(&at), &size) != 0)
    throw std::runtime_error("faulty wire: cannot listen");
  port_ = ntohs(at.sin_port);
  state_->thread = std::thread([this] { run(); });
}

FaultyWire::~FaultyWire() {
  state_->end = true;
  state_->thread.join();
  ::close(state_->listener);
}

void FaultyWire::set(Cable cable) {
  const std::lock_guard lock(state_->mutex);
  state_->cable = cable;
}
void FaultyWire::set(Change change) {
  const std::lock_guard lock(state_->mutex);
  state_->change = std::move(change);
}
void FaultyWire::set_pieces(std::size_t bytes, int pause_ms) {
  const std::lock_guard lock(state_->mutex);
  state_->piece = bytes;
  state_->pause_ms = pause_ms;
}

void FaultyWire::set_delay(int milliseconds) {
  const std::lock_guard lock(state_->mutex);
  state_->delay_ms = milliseconds;
}

void FaultyWire::set_observer(std::function<void(bool, bool)> observer) {
  const std::lock_guard lock(state_->mutex);
  state_->observer = std::move(observer);
}

void FaultyWire::run() {
  bool on_its_way = false;  // bytes that leave later
  while (!state_->end) {
    std::vector<pollfd> entries{{state_->listener, POLLIN, 0}};
    for (const Session& s : state_->sessions) {
      entries.push_back({s.program, POLLIN, 0});
      entries.push_back({s.robot, POLLIN, 0});
    }
    ::poll(entries.data(), entries.size(), on_its_way ? 1 : 5);
    on_its_way = false;
    const std::lock_guard lock(state_->mutex);
    std::size_t k = 1;
    for (Session& s : state_->sessions) {
      if (state_->cable == Cable::reset) {
        const linger at_once{1, 0};
        for (const int fd : {s.program, s.robot})
          ::setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
        s.close();
      }
      if (s.open && entries[k].revents != 0) pass(s, false);
      if (s.open && entries[k + 1].revents != 0) pass(s, true);
      while (s.open && !s.late.empty() && s.late.front().due <= std::chrono::steady_clock::now()) {
        const Session::Late late = std::move(s.late.front());
        s.late.pop_front();
        send(s, late.from_robot, late.bytes);
      }
      on_its_way = on_its_way || !s.late.empty();
      k += 2;
    }
    state_->sessions.remove_if([](const Session& s) { return !s.open; });
    if (entries[0].revents == 0) continue;
    const int program = ::accept(state_->listener, nullptr, nullptr);
    const int robot = program >= 0 ? connected(target_) : -1;
    if (robot < 0) {
      if (program >= 0) ::close(program);
      continue;
    }
    no_delay(program);
    no_delay(robot);
    Session& s = state_->sessions.emplace_back();
    s.program = program;
    s.robot = robot;
  }
  state_->sessions.clear();
}

void FaultyWire::pass(Session& s, bool from_robot) {
  Bytes chunk(65536);
  const auto n = ::recv(from_robot ? s.robot : s.program, chunk.data(), chunk.size(), 0);
  const Cable way = from_robot ? Cable::from_robot : Cable::to_robot;
  const bool passes = state_->cable == Cable::whole || state_->cable == way;
  if (n <= 0) {
    // Behind a cut cable nobody hears that the other end has hung up.
    if (passes) {
      s.close();
    } else {
      int& gone = from_robot ? s.robot : s.program;
      ::close(gone);
      gone = -1;
    }
    return;
  }
  if (!passes) return;
  chunk.resize(static_cast<std::size_t>(n));
  if (state_->observer) state_->observer(from_robot, false);
  Bytes out;
  if (!rtde_) {
    out = std::move(chunk);
  } else {
    Bytes& rest = from_robot ? s.down : s.up;
    rest.insert(rest.end(), chunk.begin(), chunk.end());
    std::size_t at = 0;
    while (rest.size() - at >= 3) {
      const std::size_t size = std::size_t(rest[at]) << 8 | rest[at + 1];
      if (size < 3 || rest.size() - at < size) break;
      Bytes p(rest.begin() + static_cast<std::ptrdiff_t>(at),
              rest.begin() + static_cast<std::ptrdiff_t>(at + size));
      at += size;
      if (from_robot)
        s.layout.answered(p);
      else
        s.layout.asked(p);
      const auto changed = from_robot && state_->change ? state_->change(std::move(p), s.layout)
                                                        : std::vector<Bytes>{std::move(p)};
      for (const Bytes& b : changed) out.insert(out.end(), b.begin(), b.end());
    }
    rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(at));
    if (rest.size() > most_waiting) s.close();
  }
  if (state_->delay_ms == 0 && s.late.empty()) return send(s, from_robot, out);
  const auto wait = std::chrono::milliseconds(state_->delay_ms);
  s.late.push_back({std::chrono::steady_clock::now() + wait, from_robot, std::move(out)});
}

void FaultyWire::send(Session& s, bool from_robot, const Bytes& out) {
  if (s.open && !send_all(from_robot ? s.program : s.robot, out, from_robot ? state_->piece : 0,
                          from_robot ? state_->pause_ms : 0))
    s.close();
  if (state_->observer) state_->observer(from_robot, true);
}

}  // namespace simulated_ur5
