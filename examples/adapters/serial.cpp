#include "examples/adapters/serial.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace adapters {

can::Descriptor open_serial(const std::string& device, unsigned speed) {
  constexpr std::array<std::pair<unsigned, speed_t>, 6> speeds{{{9600, B9600},
                                                                {115200, B115200},
                                                                {230400, B230400},
                                                                {460800, B460800},
                                                                {921600, B921600},
                                                                {1000000, B1000000}}};
  const auto fail = [&](const char* what) { throw ConnectionError("serial line '" + device + "': " + what); };
  speed_t known = B0;
  for (const auto& [bits, code] : speeds)
    if (bits == speed) known = code;
  if (known == B0) fail(("no speed of " + std::to_string(speed) + " bits a second").c_str());
  can::Descriptor fd(::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (fd.get() < 0) fail(std::strerror(errno));
  termios settings{};
  if (::tcgetattr(fd.get(), &settings) < 0) fail("it is none");
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  ::cfsetspeed(&settings, known);
  if (::tcsetattr(fd.get(), TCSANOW, &settings) < 0) fail(std::strerror(errno));
  const int ready = TIOCM_DTR;  // a pseudo terminal has none, and needs none
  static_cast<void>(::ioctl(fd.get(), TIOCMBIS, &ready));
  ::tcflush(fd.get(), TCIFLUSH);
  return fd;
}

Read read_some(const can::Descriptor& line, std::span<std::uint8_t> into, std::size_t& count,
               can::Deadline deadline) noexcept {
  count = 0;
  for (;;) {
    const auto n = ::read(line.get(), into.data(), into.size());
    if (n > 0) return count = static_cast<std::size_t>(n), Read::some;
    if (n == 0) return Read::closed;
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return Read::closed;
    if (!can::wait_for(line.get(), POLLIN, deadline)) return Read::nothing;
  }
}

}  // namespace adapters
