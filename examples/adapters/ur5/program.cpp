#include "examples/adapters/ur5/program.hpp"

#include <cmath>

#include "skinctl/io/formatted.hpp"

namespace adapters::ur5 {
namespace {

std::string six(const std::array<double, 6>& x) {
  return skinctl::formatted("[%.3f, %.3f, %.3f, %.3f, %.3f, %.3f]", x[0], x[1], x[2], x[3], x[4], x[5]);
}

/// The call of `direct_torque`, in the form that the version knows.
std::string torque_call(const ProgramSettings& s) {
  if (!s.version.takes_friction_scales())
    return std::string("direct_torque(q, friction_comp=") + (s.torque.friction ? "True" : "False") + ")";
  const std::array<double, 6> none{};
  return "direct_torque(q, viscous_scale=" + six(s.torque.friction ? s.torque.viscous : none) +
         ", coulomb_scale=" + six(s.torque.friction ? s.torque.coulomb : none) + ")";
}

}  // namespace

std::string program(const ProgramSettings& s) {
  const bool by_torque = s.interface == skinctl::Interface::torque;
  const std::string torque = by_torque ? "      elif m == 8:\n        " + torque_call(s) + "\n" : "";
  const std::string register_ = std::to_string(echo_register);
  const std::string begin =
      s.echo ? "  read = 0\n  write_output_integer_register(" + register_ + ", read)\n" : "";
  const std::string echo = s.echo ? "      read = read % " + std::to_string(echo_numbers) +
                                        " + 1\n      write_output_integer_register(" + register_ + ", read)\n"
                                  : "";
  // One thread moves, the other reads; what is read counts until the next message or the time-out in it.
  return skinctl::formatted(R"(def skinctl():
  steptime = %.6f
  global target = [0, 0, 0, 0, 0, 0]
  global mode = 0
  thread mover():
    while True:
      enter_critical
      q = target
      m = mode
      exit_critical
      if m == 1:
        servoj(q, t=steptime, lookahead_time=%.2f, gain=2000)
      elif m == 2:
        speedj(q, 40.0, steptime)
%s      else:
        stopj(4.0)
        sync()
      end
    end
  end
  if not socket_open("%s", %u, "reverse_socket"):
    popup("skinctl: the computer cannot be reached", error=True)
    halt
  end
  moving = run mover()
%s  timeout = 2.0
  alive = True
  while alive:
    got = socket_read_binary_integer(8, "reverse_socket", timeout)
    if got[0] == 8:
      timeout = got[1] / 1000.0
      enter_critical
      target = [got[2] / 1000000.0, got[3] / 1000000.0, got[4] / 1000000.0, got[5] / 1000000.0, got[6] / 1000000.0, got[7] / 1000000.0]
      mode = got[8]
      exit_critical
%s      alive = got[8] != -2
    else:
      alive = False
    end
  end
  kill moving
  stopj(4.0)
  socket_close("reverse_socket")
end
)",
                            1 / s.rate, servoj_lookahead, torque.c_str(), s.address.c_str(),
                            static_cast<unsigned>(s.port), begin.c_str(), echo.c_str());
}

std::array<std::uint8_t, 32> message(std::int32_t timeout_ms, const std::array<double, 6>& values,
                                     std::int32_t mode) noexcept {
  std::array<std::uint8_t, 32> bytes{};
  std::size_t at = 0;
  const auto put = [&](std::int32_t x) {
    const auto u = static_cast<std::uint32_t>(x);
    for (int shift = 24; shift >= 0; shift -= 8) bytes[at++] = static_cast<std::uint8_t>(u >> shift);
  };
  put(timeout_ms);
  for (const double v : values) {
    const double millionths = v * 1e6;  // |v| below 2147: a guard has seen it
    put(millionths >= -2147483647 && millionths <= 2147483647
            ? static_cast<std::int32_t>(std::lround(millionths))
            : 0);
  }
  put(mode);
  return bytes;
}

}  // namespace adapters::ur5
