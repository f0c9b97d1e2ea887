#include "examples/simulated_allegro/simulated_hand.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "examples/simulated_allegro/can_face.hpp"
#include "examples/simulated_allegro/udp_face.hpp"

namespace simulated_allegro {

using adapters::ConnectionError;
using adapters::Read;
using adapters::Timeout;
using adapters::can::Descriptor;
using adapters::can::FrameSocket;
using adapters::can::SlcanLink;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

adapters::can::FrameSocket SimulatedHand::pair() {
  auto ends = FrameSocket::pair();
  thread_ = std::thread([this, link = std::move(ends[0])]() mutable { serve_can(std::move(link)); });
  return std::move(ends[1]);
}

std::string SimulatedHand::terminal() {
  Descriptor own(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (own.get() < 0 || ::grantpt(own.get()) != 0 || ::unlockpt(own.get()) != 0)
    throw ConnectionError(std::string("no pseudo-terminal: ") + std::strerror(errno));
  char name[128] = {};
  if (::ptsname_r(own.get(), name, sizeof name) != 0) throw ConnectionError("no name of a pseudo-terminal");
  other_end_ = Descriptor(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (other_end_.get() < 0 || ::tcgetattr(other_end_.get(), &settings) != 0)
    throw ConnectionError(std::string("pseudo-terminal: ") + std::strerror(errno));
  ::cfmakeraw(&settings);
  ::tcsetattr(other_end_.get(), TCSANOW, &settings);
  thread_ = std::thread([this, fd = std::move(own)]() mutable { serve_can(SlcanLink::of(std::move(fd))); });
  return name;
}

void SimulatedHand::bus(const std::string& interface) {
  thread_ =
      std::thread([this, link = FrameSocket::open(interface)]() mutable { serve_can(std::move(link)); });
}

std::uint16_t SimulatedHand::udp(std::uint16_t port) {
  Descriptor fd(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  here.sin_port = htons(port);
  socklen_t size = sizeof here;
  if (fd.get() < 0 || ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&here), size) < 0 ||
      ::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&here), &size) < 0)
    throw ConnectionError("UDP port " + std::to_string(port) + ": " + std::strerror(errno));
  thread_ = std::thread([this, own = std::move(fd)]() mutable { serve_udp(std::move(own)); });
  return ntohs(here.sin_port);
}

void SimulatedHand::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

template <class Link>
void SimulatedHand::serve_can(Link link) {
  const Config& c = body_.config();
  CanFace face(body_);
  const auto flush = [&] {
    for (auto& queue = face.outgoing(); !queue.empty(); queue.pop_front())
      if (!link.write(queue.front(), Timeout(20))) break;  // nobody reads: lost
  };
  auto tick = Clock::now();
  const auto patience =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(c.patience));
  // Before the first torque nobody may be listening: then it goes on slowly by itself.
  const auto waits = [&] { return face.talks() && body_.snapshot().torques > 0; };
  while (!stop_) {
    adapters::allegro::Frame f;
    if (c.speed > 0)
      tick +=
          std::chrono::duration_cast<Clock::duration>(milliseconds(std::max(1, face.period_ms())) / c.speed);
    const auto until =
        c.speed > 0 ? tick : Clock::now() + (waits() ? patience : Clock::duration(milliseconds(5)));
    while (!stop_ && !(c.speed == 0 && face.talks() && face.answered())) {
      const Read got = link.read(f, until);
      if (got == Read::closed) {
        body_.advance(body_.plant().time() + 0.01);  // what came last still acts
        show();
        return;
      }
      if (got == Read::nothing) break;
      const bool before = face.talks();
      face.take(f);
      flush();
      show();
      if (c.speed == 0 && before != face.talks()) break;
    }
    if (body_.past(c.faults.unplug_at)) return;
    if (face.talks() || c.speed > 0)
      body_.advance(body_.plant().time() + std::max(1, face.period_ms()) / 1000.0);
    if (face.talks()) face.tell();
    flush();
    show();
  }
}

void SimulatedHand::serve_udp(Descriptor fd) {
  const Config& c = body_.config();
  UdpFace face(body_);
  sockaddr_in peer{};
  std::vector<std::uint8_t> buffer(2048);
  const auto flush = [&] {
    for (auto& queue = face.outgoing(); !queue.empty(); queue.pop_front())
      if (peer.sin_port != 0)
        static_cast<void>(::sendto(fd.get(), queue.front().data(), queue.front().size(), 0,
                                   reinterpret_cast<const sockaddr*>(&peer), sizeof peer));
  };
  auto tick = Clock::now();
  const auto patience =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(c.patience));
  const auto waits = [&] { return face.talks() && body_.snapshot().torques > 0; };
  while (!stop_) {
    if (c.speed > 0) tick += std::chrono::duration_cast<Clock::duration>(milliseconds(3) / c.speed);
    const auto until =
        c.speed > 0 ? tick : Clock::now() + (waits() ? patience : Clock::duration(milliseconds(5)));
    while (!stop_ && !(c.speed == 0 && face.talks() && face.answered())) {
      sockaddr_in from{};
      socklen_t size = sizeof from;
      const auto n =
          ::recvfrom(fd.get(), buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
      if (n < 0) {
        if (!adapters::can::wait_for(fd.get(), POLLIN, until)) break;
        continue;
      }
      const bool before = face.talks();
      if (face.take({buffer.data(), static_cast<std::size_t>(n)})) peer = from;
      flush();
      show();
      if (c.speed == 0 && before != face.talks()) break;
    }
    if (body_.past(c.faults.unplug_at)) return;
    if (face.talks() || c.speed > 0) body_.advance(body_.plant().time() + 0.003);
    if (face.talks()) face.tell();
    flush();
    show();
  }
}

}  // namespace simulated_allegro
