#include "skinctl/skin_network/cell_link.hpp"

#include <doctest/doctest.h>

#include <deque>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// Two ends, and a wire between them that delays, loses and spoils frames. Each end sends messages that it
// counts.
struct Link {
  struct Side {
    LinkEnd end;
    std::deque<std::pair<int, FrameBytes>> arriving;  // when, and what
    std::uint16_t sent = 0;
    std::vector<std::uint16_t> received;
    std::vector<std::size_t> downs;  // messages that were received when a port of either end went down
    int waits = 0;
  };
  Side sides[2];
  LinkSettings settings;
  double loss = 0, spoilt = 0, no_room = 0;
  Random random;
  int now = 0, spoilt_frames = 0;
  bool stuck[2] = {};  // what goes to an end waits in the wire

  void post(int to, const LinkFrame& frame) {
    auto bytes = encode(frame);
    if (uniform(random, 0.0, 1.0) < loss) return;
    if (uniform(random, 0.0, 1.0) < spoilt) {
      bytes[random() % bytes.size()] ^= std::uint8_t(1u << random() % 8);
      ++spoilt_frames;
    }
    sides[to].arriving.push_back({now + 1 + int(random() % 8), bytes});
  }
  void take(int k, const LinkEnd::Result& r) {
    if (r.received) sides[k].received.push_back(r.received->a);
    if (r.port == LinkEnd::Port::went_down || r.port == LinkEnd::Port::restarted)
      for (auto& side : sides) side.downs.push_back(side.received.size());
    if (r.send) post(1 - k, *r.send);
  }
  void step() {
    ++now;
    for (int k = 0; k < 2; ++k) {
      auto& side = sides[k];
      while (!stuck[k] && !side.arriving.empty() && side.arriving.front().first <= now) {
        const auto frame = decode(side.arriving.front().second);
        side.arriving.pop_front();
        if (frame) take(k, side.end.receive(*frame, uniform(random, 0.0, 1.0) >= no_room));
      }
      if (now % 20 == 7 * k) take(k, side.end.beat(settings));
      if (side.end.free()) {
        side.waits = 0;
        const CellMessage message{.kind = CellMessage::Kind::report, .a = ++side.sent};
        post(1 - k, side.end.send(message));
      } else if (side.end.up() && ++side.waits % 6 == 0) {
        take(k, side.end.timeout(settings));
      }
    }
  }
  void run(int steps) {
    while (steps-- > 0) step();
  }
  // In order, none twice; one is missing only where a port was down.
  void check() const {
    for (const auto& side : sides)
      for (std::size_t i = 0; i < side.received.size(); ++i) {
        const int last = i == 0 ? 0 : side.received[i - 1], next = side.received[i];
        CHECK(next > last);
        const bool went_down = std::find(side.downs.begin(), side.downs.end(), i) != side.downs.end();
        if (!went_down && i > 0) CHECK(next == last + 1);
      }
  }
};

}  // namespace

TEST_CASE("LinkEnd: every message arrives once and in order, however many frames are lost or spoilt") {
  for (const double loss : {0.0, 0.1, 0.3, 0.5})
    for (const double no_room : {0.0, 0.5}) {
      Link link;
      link.loss = loss, link.spoilt = 0.1, link.no_room = no_room;
      link.random = seeded(std::uint64_t(100 * loss + 1));
      link.settings.missed = 200;  // spoilt frames are lost as well
      link.settings.tries = 200;
      link.run(4000);
      CAPTURE(loss);
      link.check();
      CHECK(link.spoilt_frames > 100);
      for (const auto& side : link.sides) {
        CHECK(side.downs.empty());
        CHECK(side.received.size() > (loss < 0.4 ? 100 : 30));
      }
    }
}

TEST_CASE("LinkEnd: cut links go down at both ends, and come up again without a message twice") {
  Link link;
  link.random = seeded(5);
  for (int cut = 0; cut < 60; ++cut) {
    link.loss = 0;
    const auto before = link.sides[0].received.size();
    link.run(300);
    for (const auto& side : link.sides) CHECK(side.end.up());
    CHECK(link.sides[0].received.size() > before + 10);
    // Cut; or old frames arrive after one end has given up, or both have.
    link.loss = cut % 3 == 0 ? 1 : 0;
    link.stuck[0] = cut % 3 != 0, link.stuck[1] = cut % 3 == 1;
    link.run(100 + int(link.random() % 200));
    if (cut % 3 == 0)
      for (const auto& side : link.sides) CHECK_FALSE(side.end.up());
    link.stuck[0] = link.stuck[1] = false;
  }
  link.check();
  CHECK(link.sides[0].downs.size() >= 20);
}

TEST_CASE("LinkEnd: links that lose frames are given time") {
  CHECK(LinkSettings::for_loss(0).tries == 12);
  CHECK(LinkSettings::for_loss(0).missed == 3);
  for (const double loss : {0.1, 0.3, 0.5}) {
    const auto s = LinkSettings::for_loss(loss);
    CHECK(std::pow(loss, s.missed) <= 1.1e-9);
    CHECK(std::pow(1 - (1 - loss) * (1 - loss), s.tries) <= 1.1e-9);
  }
  for (const double wrong : {-0.01, 0.51, std::nan("")})
    CHECK_THROWS_AS(static_cast<void>(LinkSettings::for_loss(wrong)), ConfigurationError);
}
