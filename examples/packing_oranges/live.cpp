#include "examples/packing_oranges/live.hpp"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "examples/adapters/live/foxglove_server.hpp"
#include "examples/live_page/page.hpp"
#include "examples/support/text.hpp"

namespace packing {
using examples::text;
namespace {
std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::span<const unsigned char> bytes_of(const std::string& s) {
  return {reinterpret_cast<const unsigned char*>(s.data()), s.size()};
}
std::string list(const skinctl::Capsule<>& c) {
  return text("[%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f]", c.from.x, c.from.y, c.from.z, c.to.x, c.to.y, c.to.z,
              c.radius);
}
template <class Range, class F>
std::string each(const Range& range, const F& f) {
  std::string out = "[";
  for (const auto& x : range) out += (out.size() > 1 ? "," : "") + f(x);
  return out + "]";
}
}  // namespace

std::string json(const Scenery& s) {
  const auto arm = [](const ArmScenery& a) {
    return "{\"parts\":" + each(a.parts, list) + ",\"fingers\":" + each(a.fingers, list) +
           text(
               ",\"force\":%.2f,\"step\":\"%s\",\"state\":\"%s\",\"touched\":%s,\"kept\":%s,\"box\":%s,"
               "\"stiffness\":%.0f,\"good\":%s}",
               a.force, a.step, a.state, a.touched ? "true" : "false", a.kept ? "true" : "false",
               a.has_box ? "true" : "false", a.stiffness, a.said_good ? "true" : "false");
  };
  const auto orange = [](const OrangeScenery& o) {
    return text("[%.3f,%.3f,%.3f,%.3f]", o.p.x, o.p.y, o.p.z, o.radius);
  };
  return text("{\"time\":%.3f,\"robot\":\"%s\",", s.time, s.robot.c_str()) + "\"arms\":" + each(s.arm, arm) +
         ",\"oranges\":" + each(s.oranges, orange) + ",\"things\":" + each(s.things, orange) +
         (s.robot_stands ? text(",\"stands\":[%.3f,%.3f,%.4f]", s.robot_stands->x, s.robot_stands->y,
                                s.robot_stands->yaw)
                         : "") +
         text(",\"box\":%d,\"bins\":%d,\"lost\":%d,\"all\":%d}", s.box, s.bins, s.lost, s.all);
}
std::string json_of_trays(const Trays& standing) {
  std::vector<Tray> all{standing[0]};
  for (std::size_t a = 0; a < arms; ++a) all.push_back(standing[1 + a]), all.push_back(feed_tray(a));
  return each(all, [](const Tray& t) {
    return text("[%.3f,%.3f,%.3f,%.3f,%.3f]", t.x, t.y, t.half_x, t.half_y, t.wall);
  });
}

struct LivePage::Impl {
  std::atomic<skinctl::CycleRequest> asked{skinctl::CycleRequest::none};
  std::unique_ptr<adapters::live::FoxgloveServer> server;
  std::uint32_t trays = 0, state = 0;
  std::string trays_shown;
};

LivePage::LivePage(std::uint16_t port, bool allow_control) : impl_(std::make_unique<Impl>()) {
  using namespace adapters::live;
  ServerOptions o;
  o.port = port;
  o.allow_control = allow_control;
  o.name = "packing_oranges";
  live_page::put_page(o);
  const std::filesystem::path folder = PACKING_ORANGES_FOLDER;
  o.files["/"] = {"text/html; charset=utf-8", read(folder / "live.html")};
  o.files["/packing.js"] = {"text/javascript; charset=utf-8", read(folder / "live.js")};
  impl_->server = std::make_unique<FoxgloveServer>(std::move(o));
  impl_->trays = impl_->server->add(Channel{"/packing/trays", "json", "", "", "", true});
  impl_->state = impl_->server->add(Channel{"/packing/state", "json", "", "", "", false});
  const auto ask = [this](skinctl::CycleRequest request, const char* words) {
    return [this, request, words] {
      impl_->asked.store(request);
      return Answer{true, words};
    };
  };
  impl_->server->add(
      Service{"/packing/stop", false, ask(skinctl::CycleRequest::stop, "both arms brake, and hold")});
  impl_->server->add(Service{"/packing/resume", true, ask(skinctl::CycleRequest::resume, "both arms go on")});
  impl_->server->start();
  show({});
}
LivePage::~LivePage() = default;

std::string LivePage::url() const {
  return impl_->server->url();
}
void LivePage::show(const Scenery& s) {
  if (std::string trays = json_of_trays(s.trays); trays != impl_->trays_shown) {
    impl_->server->publish(impl_->trays, skinctl::nanoseconds(s.time), bytes_of(trays));
    impl_->trays_shown = std::move(trays);
  }
  if (impl_->server->wanted(impl_->state))
    impl_->server->publish(impl_->state, skinctl::nanoseconds(s.time), bytes_of(json(s)));
}
skinctl::CycleRequest LivePage::take() {
  return impl_->asked.exchange(skinctl::CycleRequest::none);
}

}  // namespace packing
