#include "examples/fault_table/network_link.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <mutex>
#include <queue>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

namespace fault_table {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void refuse(const char* what) {
  throw std::runtime_error(std::string("a network of its own: ") + what + ": " + std::strerror(errno));
}

class Handle {
 public:
  Handle() = default;
  explicit Handle(int fd) noexcept : fd_(fd) {}
  Handle(Handle&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Handle() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const noexcept { return fd_; }

 private:
  int fd_ = -1;
};

/// One end of the wire: a namespace, and the point-to-point device in it.
struct End {
  Handle space, device;
};

void set_address(int socket, ifreq request, unsigned long what, const char* address) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  ::inet_pton(AF_INET, address, &in.sin_addr);
  std::memcpy(&request.ifr_addr, &in, sizeof in);
  if (::ioctl(socket, what, &request) < 0) refuse("address of the device");
}
void bring_up(int socket, const char* name) {
  ifreq request{};
  std::snprintf(request.ifr_name, sizeof request.ifr_name, "%s", name);
  if (::ioctl(socket, SIOCGIFFLAGS, &request) < 0) refuse(name);
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP);
  if (::ioctl(socket, SIOCSIFFLAGS, &request) < 0) refuse(name);
}

/// Leaves the calling thread in the new namespace.
End make_end(const char* own, const char* peer) {
  if (::unshare(CLONE_NEWNET) != 0) refuse("unshare");
  End end;
  end.space = Handle(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC));
  if (end.space.get() < 0) refuse("/proc/thread-self/ns/net");
  end.device = Handle(::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (end.device.get() < 0) refuse("/dev/net/tun");
  ifreq request{};
  std::snprintf(request.ifr_name, sizeof request.ifr_name, "wire");
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  if (::ioctl(end.device.get(), TUNSETIFF, &request) < 0) refuse("TUNSETIFF");
  const Handle socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  request.ifr_flags = 0;
  set_address(socket.get(), request, SIOCSIFADDR, own);
  set_address(socket.get(), request, SIOCSIFDSTADDR, peer);
  bring_up(socket.get(), "lo");
  bring_up(socket.get(), "wire");
  return end;
}
/// On a thread of its own: only that one moves into the namespace.
End made_end(const char* own, const char* peer) {
  End end;
  std::exception_ptr failed;
  std::thread([&] {
    try {
      end = make_end(own, peer);
    } catch (...) {
      failed = std::current_exception();
    }
  }).join();
  if (failed) std::rethrow_exception(failed);
  return end;
}

std::uint32_t big_endian(const std::uint8_t* at, int bytes) noexcept {
  std::uint32_t x = 0;
  for (int k = 0; k < bytes; ++k) x = x << 8 | at[k];
  return x;
}

/// Ports, number and payload of an IPv4 packet.
void look(const std::vector<std::uint8_t>& p, SeenPacket& seen) noexcept {
  if (p.size() < 40 || p[0] >> 4 != 4) return;
  const std::size_t header = 4u * (p[0] & 15u);
  if (p.size() < header + 20 || (p[9] != 6 && p[9] != 17)) return;
  seen.tcp = p[9] == 6;
  seen.source = static_cast<std::uint16_t>(big_endian(&p[header], 2));
  seen.destination = static_cast<std::uint16_t>(big_endian(&p[header + 2], 2));
  if (!seen.tcp) return;
  seen.sequence = big_endian(&p[header + 4], 4);
  seen.length = static_cast<std::uint32_t>(p.size() - header - 4u * (p[header + 12] >> 4));
}

struct Packet {
  Clock::time_point due;
  std::uint64_t number = 0;
  int to = 0;  ///< end
  std::vector<std::uint8_t> bytes;
  bool operator<(const Packet& other) const noexcept {
    return due != other.due ? due > other.due : number > other.number;
  }
};

}  // namespace

struct NetworkLink::Wire {
  explicit Wire(std::uint64_t seed)
      : job(made_end(job_address, robot_address)),
        robot(made_end(robot_address, job_address)),
        wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
        random(seed),
        thread([this] { run(); }) {}
  ~Wire() {
    over = true;
    static_cast<void>(::eventfd_write(wake.get(), 1));
    thread.join();
  }

  bool happens(double share) { return share > 0 && uniform(random) < share; }

  SeenPacket seen(const Packet& p, Clock::time_point now, bool lost) const {
    SeenPacket out;
    out.time = std::chrono::duration<double>(now - made).count();
    out.to_robot = p.to == 1;
    out.lost = lost;
    look(p.bytes, out);
    return out;
  }
  void observe(const Packet& p, Clock::time_point now, bool lost) {
    if (observer) observer(seen(p, now, lost));
  }

  void take(int from) {
    std::array<std::uint8_t, 2048> room;
    for (;;) {
      const auto n = ::read(ends[static_cast<std::size_t>(from)]->device.get(), room.data(), room.size());
      if (n <= 0) return;
      LinkFault now_;
      {
        const std::lock_guard lock(mutex);
        now_ = fault;
      }
      Packet p;
      p.bytes.assign(room.begin(), room.begin() + n);
      p.to = 1 - from;
      const auto now = Clock::now();
      const bool lost = now_.down || happens(now_.loss) || (judge && judge(seen(p, now, false)));
      if (lost) {
        observe(p, now, true);
        continue;
      }
      const double wait = now_.delay + (now_.jitter > 0 ? now_.jitter * uniform(random) : 0);
      auto& last = last_due[static_cast<std::size_t>(from)];
      p.due = std::max(
          last, now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wait)));
      last = p.due;
      if (happens(now_.reorder))
        p.due +=
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(LinkFault::overtaken));
      p.number = ++count;
      if (happens(now_.duplicate)) {
        Packet twice = p;
        twice.number = ++count;
        queue.push(std::move(twice));
      }
      queue.push(std::move(p));
    }
  }

  void run() {
    sched_param priority{};
    priority.sched_priority = 20;  // a wire does not wait for programs; without the right to, it does
    static_cast<void>(::sched_setscheduler(0, SCHED_FIFO, &priority));
    std::array<pollfd, 3> handles{
        {{job.device.get(), POLLIN, 0}, {robot.device.get(), POLLIN, 0}, {wake.get(), POLLIN, 0}}};
    while (!over) {
      timespec wait{3600, 0};
      if (!queue.empty()) {
        const auto left = std::max(Clock::duration(0), queue.top().due - Clock::now());
        wait = {std::chrono::duration_cast<std::chrono::seconds>(left).count(),
                std::chrono::nanoseconds(left % std::chrono::seconds(1)).count()};
      }
      static_cast<void>(::ppoll(handles.data(), handles.size(), &wait, nullptr));
      take(0);
      take(1);
      const auto now = Clock::now();
      while (!queue.empty() && queue.top().due <= now) {
        const Packet& p = queue.top();
        observe(p, now, false);
        static_cast<void>(
            !::write(ends[static_cast<std::size_t>(p.to)]->device.get(), p.bytes.data(), p.bytes.size()));
        queue.pop();
      }
    }
  }

  End job, robot;
  const std::array<End*, 2> ends{&job, &robot};
  Handle wake;
  const Clock::time_point made = Clock::now();
  std::mutex mutex;
  LinkFault fault;
  std::function<void(const SeenPacket&)> observer;
  std::function<bool(const SeenPacket&)> judge;
  std::mt19937_64 random;
  std::uniform_real_distribution<double> uniform{0, 1};
  std::priority_queue<Packet> queue;
  std::array<Clock::time_point, 2> last_due{};
  std::uint64_t count = 0;
  std::atomic<bool> over = false;
  std::thread thread;

  static std::thread inside(const End& end, std::function<void()> f) {
    return std::thread([space = end.space.get(), f = std::move(f)] {
      if (::setns(space, CLONE_NEWNET) != 0) std::terminate();  // it could be made, so it can be entered
      f();
    });
  }
};

NetworkLink::NetworkLink(std::uint64_t seed) : wire_(std::make_unique<Wire>(seed)) {}
NetworkLink::~NetworkLink() = default;

std::thread NetworkLink::at_job(std::function<void()> f) {
  return Wire::inside(wire_->job, std::move(f));
}
std::thread NetworkLink::at_robot(std::function<void()> f) {
  return Wire::inside(wire_->robot, std::move(f));
}
void NetworkLink::set(const LinkFault& fault) {
  const std::lock_guard lock(wire_->mutex);
  wire_->fault = fault;
}
void NetworkLink::set_judge(std::function<bool(const SeenPacket&)> judge) {
  wire_->judge = std::move(judge);
}
void NetworkLink::set_observer(std::function<void(const SeenPacket&)> observer) {
  wire_->observer = std::move(observer);
}

void become_root_of_own_namespace() noexcept {
  const auto user = ::geteuid();
  const auto group = ::getegid();
  if (user == 0 || ::unshare(CLONE_NEWUSER) != 0) return;
  const auto write = [](const char* file, const std::string& text) {
    const Handle out(::open(file, O_WRONLY | O_CLOEXEC));
    static_cast<void>(!::write(out.get(), text.data(), text.size()));
  };
  write("/proc/self/setgroups", "deny");
  write("/proc/self/uid_map", "0 " + std::to_string(user) + " 1");
  write("/proc/self/gid_map", "0 " + std::to_string(group) + " 1");
}

}  // namespace fault_table
