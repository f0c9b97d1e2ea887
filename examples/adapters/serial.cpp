#include "examples/adapters/serial.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>

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

}  // namespace adapters
