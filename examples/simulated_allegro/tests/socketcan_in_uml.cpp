// Driver and simulated hand over a real SocketCAN bus, on kernels without one too: this program boots Linux
// as a process (Debian package user-mode-linux) with itself as init, on a read-only view of this machine's
// files. Skipped with 77 where the package is missing.
#include <fcntl.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/reboot.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "examples/adapters/allegro/driver.hpp"
#include "examples/simulated_allegro/simulated_hand.hpp"

namespace {

using namespace adapters::allegro;
namespace fs = std::filesystem;

constexpr const char* good = "SOCKETCAN OK";

void load(const fs::path& module) {
  const Descriptor fd(::open(module.c_str(), O_RDONLY | O_CLOEXEC));
  if (fd.get() < 0 || (::syscall(SYS_finit_module, fd.get(), "", 0) != 0 && errno != EEXIST))
    std::printf("module %s: %s\n", module.c_str(), std::strerror(errno));
}

/// `ip link add vcan0 type vcan; ip link set vcan0 up`.
void add_bus() {
  struct {
    nlmsghdr head{};
    ifinfomsg info{};
    char attributes[128] = {};
  } request;
  std::size_t at = 0;
  const auto add = [&](unsigned short type, const void* data, std::size_t size) {
    rtattr* a = reinterpret_cast<rtattr*>(request.attributes + at);
    a->rta_type = type;
    a->rta_len = static_cast<unsigned short>(RTA_LENGTH(size));
    if (size > 0) std::memcpy(RTA_DATA(a), data, size);
    at += RTA_ALIGN(a->rta_len);
    return a;
  };
  add(IFLA_IFNAME, "vcan0", 6);
  rtattr* nest = add(IFLA_LINKINFO, nullptr, 0);
  const std::size_t before = at;
  add(IFLA_INFO_KIND, "vcan", 4);
  nest->rta_len = static_cast<unsigned short>(nest->rta_len + (at - before));
  request.head.nlmsg_len = static_cast<unsigned>(NLMSG_LENGTH(sizeof request.info) + at);
  request.head.nlmsg_type = RTM_NEWLINK;
  request.head.nlmsg_flags = NLM_F_REQUEST | NLM_F_CREATE | NLM_F_EXCL | NLM_F_ACK;
  const Descriptor link(::socket(AF_NETLINK, SOCK_RAW, NETLINK_ROUTE));
  if (::send(link.get(), &request, request.head.nlmsg_len, 0) < 0) throw std::runtime_error("netlink");
  char answer[512];
  static_cast<void>(::recv(link.get(), answer, sizeof answer, 0));
  ifreq up{};
  std::strcpy(up.ifr_name, "vcan0");
  const Descriptor any(::socket(AF_INET, SOCK_DGRAM, 0));
  up.ifr_flags = IFF_UP;
  if (::ioctl(any.get(), SIOCSIFFLAGS, &up) != 0) throw std::runtime_error("vcan0 does not come up");
}

/// In the booted kernel.
void inside(const fs::path& modules) {
  for (const char* m :
       {"drivers/net/can/dev/can-dev.ko", "net/can/can.ko", "net/can/can-raw.ko", "drivers/net/can/vcan.ko"})
    load(modules / "kernel" / m);
  add_bus();
  for (const Generation g : {Generation::v4, Generation::v5_sense}) {
    simulated_allegro::Config config;
    config.generation = g;
    config.speed = 0;
    simulated_allegro::SimulatedHand hand(config);
    hand.bus("vcan0");
    HandOptions options;
    options.generation = g;
    options.stamps = Stamps::counted;
    Driver driver(CanHand(FrameSocket::open("vcan0")), options, {.give_up = adapters::Timeout(10000)});
    driver.connect();
    skinctl::State<16> state;
    for (int k = 0; k < 300; ++k) {
      if (driver.wait(state) != skinctl::Heard::state)
        throw std::runtime_error("no state: " + driver.error());
      skinctl::TorqueCommand<16> c;
      c.valid = true;
      for (std::size_t i = 0; i < 16; ++i) c.torque[i] = 0.6 * (0.4 - state.q[i]);
      if (!driver.send(c)) throw std::runtime_error("not sent: " + driver.error());
    }
    if (std::abs(state.q[1] - 0.4) > 0.08) throw std::runtime_error("the hand does not follow");
    if (driver.condition().incomplete != 0) throw std::runtime_error("frames were lost");
    driver.stop();
    for (int k = 0; k < 3000 && hand.snapshot().servo; ++k) ::usleep(1000);
    if (hand.snapshot().servo) throw std::runtime_error("the servo is still on");
  }
  std::printf("%s\n", good);
}

/// The modules of the kernel of the package, or empty.
fs::path modules() {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/usr/lib/uml/modules", error))
    if (fs::exists(entry.path() / "kernel/drivers/net/can/vcan.ko", error)) return entry.path();
  return {};
}

int outside() {
  const fs::path found = modules();
  if (found.empty() || !fs::exists("/usr/bin/linux.uml")) {
    std::printf("SKIPPED: no user-mode-linux here. On Debian 12: sudo apt-get install user-mode-linux\n");
    return 77;
  }
  char folder[] = "/tmp/skinctl-uml-XXXXXX";
  if (::mkdtemp(folder) == nullptr) return 1;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return 1;
  const std::string self = fs::read_symlink("/proc/self/exe"), init = "init=" + self,
                    place = std::string("uml_dir=") + folder, where = found.string();
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::setpgid(0, 0);
    ::dup2(ends[1], 1);
    ::dup2(ends[1], 2);
    ::dup2(::open("/dev/null", O_RDONLY), 0);
    ::execl("/usr/bin/linux.uml", "linux.uml", "mem=128M", "rootfstype=hostfs", "rootflags=/", "ro", "quiet",
            "con=null", "con0=null,fd:1", "ssl=null", place.c_str(), init.c_str(), "--", where.c_str(),
            nullptr);
    ::_exit(97);
  }
  ::close(ends[1]);
  std::string text;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(90);
  char block[512];
  while (wait_for(ends[0], POLLIN, deadline)) {
    const auto n = ::read(ends[0], block, sizeof block);
    if (n <= 0) break;
    text.append(block, static_cast<std::size_t>(n));
    if (text.size() > 100000) break;
  }
  ::kill(-child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  std::error_code error;
  fs::remove_all(folder, error);
  std::printf("%s\n", text.c_str());
  return text.find(good) == std::string::npos ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (::getpid() != 1) return outside();
  try {
    inside(argc > 1 ? argv[1] : modules());
  } catch (const std::exception& e) {
    std::printf("FAILED: %s\n", e.what());
  }
  std::fflush(nullptr);
  ::reboot(RB_POWER_OFF);
  return 0;
}
