// Python: a simulated UR5 with 260 cells that goes to goals and gives way to touch. The loop runs in a thread
// of its own; Python gives goals and touches, and gets copies of what happened, as arrays.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "skinctl/recording/cycle_hand_over.hpp"
#include "skinctl/skinctl.hpp"

namespace py = pybind11;

namespace {

using namespace skinctl;
using Array = py::array_t<double>;

constexpr std::array<double, 6> home = {0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
constexpr std::uint32_t cells = 260;

auto make_scene(double force_gain) {
  const auto robot = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  auto gains = tracking_settings(robot);
  gains.lambda = 12;
  gains.K_c = 2;
  gains.tb = {};
  gains.max_velocity = JointVelocity<6>::constant(0.5);
  return Cycle(robot, ur5_skin<cells>({.force = force_gain}),
               SplineJoint<6>(gains) + SkinJointControl{} + GravityControl{});
}
using Scene = decltype(make_scene(1));

/// What Python tells the loop.
struct Told {
  enum Kind : std::uint64_t { goal, touch } kind = goal;
  std::array<double, 6> q{};
  double duration = 0;
  std::uint32_t cell = 0;
  float reading = 0;
};

/// An arm that follows what it is told, at the pace of this computer's clock or as fast as it can.
struct Following {
  State<6> state;
  bool real_time = true;
  std::chrono::steady_clock::time_point next = std::chrono::steady_clock::now();
  Heard wait(State<6>& out) noexcept {
    next += std::chrono::milliseconds(8);
    if (real_time) std::this_thread::sleep_until(next);
    state.time += 8ms;
    out = state;
    return Heard::state;
  }
  bool send(const PositionCommand<6>& command) noexcept {
    state.dq =
        JointVelocity<6>::generate([&](std::size_t i) { return (command.position[i] - state.q[i]) / 0.008; });
    state.q = command.position;
    return true;
  }
  void stop() noexcept {}
};
/// The cells that are pressed, each cycle anew, and those that were let go, once.
struct Fingers {
  const Following& arm;
  std::array<float, cells + 1> pressed{};
  std::array<CellSample, cells> samples{};
  std::array<bool, cells + 1> changed{};
  std::span<const CellSample> poll() noexcept {
    std::size_t n = 0;
    for (std::uint32_t id = 1; id <= cells; ++id)
      if (pressed[id] > 0 || changed[id]) {
        samples[n++] = {
            .time = arm.state.time - 1ms, .cell = id, .force = {pressed[id], pressed[id], pressed[id]}};
        changed[id] = false;
      }
    return std::span(samples).first(n);
  }
};

class Ur5 {
 public:
  explicit Ur5(double force_gain, bool real_time) : scene_(make_scene(force_gain)), real_time_(real_time) {}
  ~Ur5() { stop(); }
  Ur5(const Ur5&) = delete;
  Ur5& operator=(const Ur5&) = delete;

  void start() {
    if (thread_.joinable()) throw std::runtime_error("the loop runs already");
    ending_ = false;
    thread_ = std::thread([this] { loop(); });
  }
  void stop() {
    ending_ = true;
    if (thread_.joinable()) thread_.join();
  }
  void goal(const Array& q, double duration) {
    if (q.ndim() != 1 || q.shape(0) != 6) throw std::invalid_argument("q: six numbers [rad]");
    Told told;
    for (py::ssize_t i = 0; i < 6; ++i) told.q[std::size_t(i)] = q.at(i);
    told.duration = duration;
    tell(told);
  }
  void touch(std::uint32_t cell, float reading) {
    if (cell < 1 || cell > cells) throw std::invalid_argument("cell: 1 to 260");
    if (!(reading >= 0 && reading <= 1)) throw std::invalid_argument("reading: 0 to 1");
    Told told;
    told.kind = Told::touch;
    told.cell = cell;
    told.reading = reading;
    tell(told);
  }
  /// Copies of all cycles since the last call.
  py::dict take() {
    std::vector<double> t, q, shares;
    std::vector<std::uint64_t> status;
    {
      py::gil_scoped_release others_may_run;
      out_.consume([](const auto&, auto) {},
                   [&](const CycleRecord<Scene>& r) {
                     t.push_back(seconds<double>(r.input.now));
                     for (std::size_t i = 0; i < 6; ++i) q.push_back(r.input.measured.q[i]);
                     for (const auto& share : r.shares)
                       for (std::size_t i = 0; i < 6; ++i) shares.push_back(share[i]);
                     status.push_back(r.status.bits());
                   });
    }
    const auto n = static_cast<py::ssize_t>(t.size());
    py::dict out;
    out["time"] = Array(n, t.data());
    out["q"] = Array({n, py::ssize_t(6)}, q.data());
    out["shares"] = Array({n, py::ssize_t(3), py::ssize_t(6)}, shares.data());
    out["status"] = py::array_t<std::uint64_t>(n, status.data());
    out["dropped"] = out_.dropped();
    return out;
  }

 private:
  void tell(const Told& told) {
    const auto room = in_.claim(sizeof told);
    if (room.empty()) throw std::runtime_error("the loop does not listen");
    std::memcpy(room.data(), &told, sizeof told);
    in_.publish(sizeof told);
  }
  void loop() {
    Following arm;
    arm.real_time = real_time_;
    arm.state.q = JointPosition<6>(home);
    Fingers skin{arm};
    const auto memory = std::make_unique<Scene::Memory>();
    run_loop(
        scene_, *memory, arm, skin, {.period = 8ms, .stop = &ending_},
        [&](Scene::Input& input, auto&) {
          in_.consume([&](std::span<const unsigned char> bytes) {
            Told told;
            std::memcpy(&told, bytes.data(), sizeof told);
            if (told.kind == Told::touch) {
              skin.pressed[told.cell] = told.reading;
              skin.changed[told.cell] = true;
              return;
            }
            input.goal = {JointPosition<6>(told.q), nanoseconds(told.duration)};
          });
          return true;
        },
        [&](const auto& input, const auto& out, const auto& watch) { out_(input, out, watch); });
  }

  Scene scene_;
  bool real_time_;
  CycleRing in_{1 << 16};
  CycleHandOver<Scene> out_{std::size_t(1) << 22};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace

PYBIND11_MODULE(skinctl_ur5, m) {
  m.doc() = "A simulated UR5 with 260 cells of skin: goals and touches in, copies of its cycles out.";
  m.attr("home") = Array(6, home.data());
  m.attr("laws") = py::make_tuple("spline joint", "skin joint", "gravity");
  m.def("reasons", [](std::uint64_t status) {
    std::vector<std::string> out;
    Status::from_bits(status).for_each([&](Reason r) { out.emplace_back(name(r)); });
    return out;
  });
  py::class_<Ur5>(m, "Ur5")
      .def(py::init<double, bool>(), py::arg("force_gain") = 40.0, py::arg("real_time") = true)
      .def("start", &Ur5::start)
      .def("stop", &Ur5::stop, py::call_guard<py::gil_scoped_release>())
      .def("goal", &Ur5::goal, py::arg("q"), py::arg("duration") = 2.0,
           "six positions [rad], and how long [s]")
      .def("touch", &Ur5::touch, py::arg("cell"), py::arg("reading"), "of each of its force sensors, 0 to 1")
      .def("take", &Ur5::take, "copies of all cycles since the last call");
}
