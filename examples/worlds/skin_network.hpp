// A simulated network of skin cells: any topology, lossy links, cuts, cells that lose their memory or lie.
#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

#include "skinctl/skin_network/cell_link.hpp"
#include "skinctl/skin_network/cell_network.hpp"
#include "skinctl/skin_network/network_root.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// Who is joined to whom. Node 0 is the PC, with as many ports as it likes; the others are cells with four.
struct SkinTopology {
  struct End {
    std::uint32_t node = 0;
    std::uint8_t port = 0;
    bool joined = false;
  };
  std::vector<std::vector<End>> ports;

  explicit SkinTopology(std::size_t cells, std::size_t boxes = 1) : ports(cells + 1, std::vector<End>(4)) {
    ports[0].resize(boxes);
  }
  [[nodiscard]] std::size_t cells() const noexcept { return ports.size() - 1; }
  void join(std::size_t a, std::size_t pa, std::size_t b, std::size_t pb) {
    ports[a][pa] = {std::uint32_t(b), std::uint8_t(pb), true};
    ports[b][pb] = {std::uint32_t(a), std::uint8_t(pa), true};
  }
  void cut(std::size_t a, std::size_t pa) {
    const End e = ports[a][pa];
    if (e.joined) ports[e.node][e.port].joined = ports[a][pa].joined = false;
  }
  [[nodiscard]] std::size_t links() const {
    std::size_t n = 0;
    for (const auto& node : ports)
      for (const End& e : node) n += e.joined;
    return n / 2;
  }
  /// A sheet of hexagonal cells as they are soldered: rows * columns, the PC at cell 1.
  [[nodiscard]] static SkinTopology sheet(std::size_t rows, std::size_t columns) {
    SkinTopology t(rows * columns);
    // Ports 1 to 4 point up right, down right, up left, down left.
    const auto at = [&](std::size_t r, std::size_t c) { return 1 + r * columns + c; };
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t c = 0; c < columns; ++c) {
        if (c + 1 < columns) t.join(at(r, c), 0, at(r, c + 1), 3);
        if (r + 1 < rows) t.join(at(r, c), 1, at(r + 1, c), 2);
      }
    // A corner's port that points outwards.
    t.join(0, 0, 1, 2);
    return t;
  }
  /// Cells joined at random, in one piece or not: loops, stars, chains, double links, cells joined to
  /// themselves by no port.
  [[nodiscard]] static SkinTopology random(Random& rng, std::size_t cells, std::size_t boxes) {
    SkinTopology t(cells, boxes);
    const auto any = [&](std::size_t n) { return std::size_t(rng() % n); };
    for (std::size_t p = 0; p < boxes; ++p)
      if (const std::size_t c = 1 + any(cells), q = any(4); !t.ports[c][q].joined) t.join(0, p, c, q);
    for (std::size_t k = 0; k < 2 * cells; ++k) {
      const std::size_t a = 1 + any(cells), b = 1 + any(cells), p = any(4), q = any(4);
      if (a != b && !t.ports[a][p].joined && !t.ports[b][q].joined) t.join(a, p, b, q);
    }
    return t;
  }
};

/// Event by event. A frame takes `hop`; a receipt, of which four bytes matter, comes `hop / 10` later.
class SkinNetwork {
 public:
  struct Settings {
    double loss = 0;     ///< share of the frames that do not arrive, receipts and beacons included
    double flipped = 0;  ///< share of the frames with flipped bits, which the CRC must find
    Nanoseconds hop = std::chrono::microseconds(200);
    Nanoseconds beat = std::chrono::milliseconds(4);
  };

  SkinNetwork(SkinTopology topology, const Settings& s, std::uint64_t seed)
      : topology_(std::move(topology)),
        s_(s),
        link_(LinkSettings::for_loss(std::min(0.5, s.loss + s.flipped))),
        random_(seeded(seed)),
        root_(topology_.ports[0].size()),
        cells_(topology_.ports.size()) {
    for (std::size_t n = 0; n < topology_.ports.size(); ++n) {
      ports_.emplace_back(topology_.ports[n].size());
      post({Nanoseconds(std::int64_t(random_() % std::uint64_t(s_.beat.count()))), Event::beat, n});
    }
  }

  [[nodiscard]] const NetworkRoot& root() const noexcept { return root_; }
  [[nodiscard]] const SkinTopology& topology() const noexcept { return topology_; }
  [[nodiscard]] const CellMemory& cell(std::size_t node) const { return cells_[node].memory; }
  [[nodiscard]] Nanoseconds now() const noexcept { return now_; }
  /// Messages that cells and PC gave their links to send, by kind.
  [[nodiscard]] std::size_t messages(CellMessage::Kind kind) const noexcept {
    return sent_[std::size_t(kind)];
  }
  void forget_messages() noexcept { sent_ = {}; }
  /// When the PC last gave out labels.
  [[nodiscard]] Nanoseconds assigned() const noexcept { return assigned_; }

  void cut(std::size_t node, std::size_t port) { topology_.cut(node, port); }
  void join(std::size_t a, std::size_t pa, std::size_t b, std::size_t pb) { topology_.join(a, pa, b, pb); }
  /// The cell's memory is as it may be; its check word is not, or is if `signed_too`.
  void corrupt(std::size_t node, const CellMemory& memory, bool signed_too) {
    cells_[node].memory = memory;
    cells_[node].check = check_word(memory) ^ (signed_too ? 0u : 1u);
  }
  /// What a cell says is passed through `lie` first.
  void lies(std::size_t node, std::function<void(CellMessage&)> lie) { cells_[node].lie = std::move(lie); }
  [[nodiscard]] CellMemory honest(std::size_t node) const { return cells_[node].memory; }

  /// Runs until `done()` or `until`; true if it is done.
  bool run(Nanoseconds until, const std::function<bool()>& done) {
    while (!events_.empty() && events_.top().at <= until) {
      const Event e = events_.top();
      events_.pop();
      now_ = e.at;
      happen(e);
      if (done()) return true;
    }
    now_ = until;
    return false;
  }
  bool run_until_organised(Nanoseconds until) {
    return run(until, [&] { return root_.state() == NetworkRoot::State::organised && !root_.due(); });
  }
  /// All cells of the tree have labels: the reports may still be on their way.
  [[nodiscard]] bool labelled() const {
    return root_.state() == NetworkRoot::State::reporting || root_.state() == NetworkRoot::State::organised;
  }

 private:
  struct Event {
    enum Kind : std::uint8_t { frame, timeout, beat, tick };
    Nanoseconds at{};
    Kind kind = frame;
    std::size_t node = 0;
    std::uint16_t port = 0;
    std::uint32_t number = 0;  // of the frame, or of the timeout
    std::uint64_t order = 0;
  };
  struct Later {
    bool operator()(const Event& a, const Event& b) const noexcept {
      return a.at != b.at ? a.at > b.at : a.order > b.order;
    }
  };
  struct Outbox {
    LinkEnd end;
    std::array<CellMessage, CellMessage::kinds> kept{};
    unsigned pending = 0;  // a message of a kind supersedes an older one
    std::uint32_t timer = 0;
  };
  struct Cell {
    CellMemory memory{};
    std::uint32_t check = check_word(CellMemory{});
    std::array<CellMessage, 8> reports{};  // on their way to the parent: a ring
    std::size_t first = 0, waiting = 0;
    std::function<void(CellMessage&)> lie{};
  };

  void post(Event e) {
    e.order = order_++;
    events_.push(e);
  }
  void transmit(std::size_t node, std::size_t port, const LinkFrame& f) {
    const auto& peer = topology_.ports[node][port];
    if (!peer.joined || chance(s_.loss)) return;
    std::uint32_t slot;
    if (free_.empty())
      slot = std::uint32_t(frames_.size()), frames_.emplace_back();
    else
      slot = free_.back(), free_.pop_back();
    frames_[slot] = encode(f);
    if (s_.flipped > 0 && chance(s_.flipped))
      for (std::uint64_t k = 0, n = 1 + random_() % 8; k < n; ++k)
        frames_[slot][random_() % frames_[slot].size()] ^= std::uint8_t(1u << random_() % 8);
    const bool small = f.kind == LinkFrame::Kind::receipt || f.kind == LinkFrame::Kind::busy;
    post({now_ + (small ? s_.hop / 10 : s_.hop), Event::frame, peer.node, peer.port, slot});
  }
  [[nodiscard]] bool chance(double p) { return p > 0 && double(random_() >> 11) * 0x1p-53 < p; }

  void happen(const Event& e) {
    if (e.kind == Event::tick) return act([&](auto& out) { root_.tick(now_, out); });
    LinkEnd::Result r;
    Outbox* box = e.kind == Event::beat ? nullptr : &ports_[e.node][e.port];
    if (e.kind == Event::frame) {
      const auto frame = decode(frames_[e.number]);
      free_.push_back(e.number);
      if (!frame || !topology_.ports[e.node][e.port].joined) return;
      const Cell& c = cells_[e.node];
      r = box->end.receive(*frame,
                           e.node == 0 || c.waiting < c.reports.size() || !keeps(c.memory, frame->message));
      take(e.node, e.port, r);
    } else if (e.kind == Event::timeout) {
      if (box->timer != e.number) return;
      take(e.node, e.port, box->end.timeout(link_));
      if (!box->end.free() && box->end.up()) arm(e.node, e.port);
    } else {
      if (e.node > 0) verify(e.node);
      for (std::size_t p = 0; p < ports_[e.node].size(); ++p)
        take(e.node, p, ports_[e.node][p].end.beat(link_));
      if (e.node == 0) act([&](auto& out) { root_.tick(now_, out); });
      post({now_ + s_.beat, Event::beat, e.node});
    }
  }
  void arm(std::size_t node, std::size_t port) {
    post({now_ + s_.hop + s_.hop / 4, Event::timeout, node, std::uint16_t(port), ++ports_[node][port].timer});
  }
  void take(std::size_t node, std::size_t port, const LinkEnd::Result& r) {
    Outbox& box = ports_[node][port];
    if (r.free) ++box.timer;
    if (r.send) transmit(node, port, *r.send);
    if (r.port == LinkEnd::Port::went_down || r.port == LinkEnd::Port::restarted) {
      box.pending = 0;
      ++box.timer;
      happened(node, {CellEvent::Kind::port_down, std::uint8_t(port), {}});
    }
    if (r.port == LinkEnd::Port::went_up || r.port == LinkEnd::Port::restarted)
      happened(node, {CellEvent::Kind::port_up, std::uint8_t(port), {}});
    if (r.received) happened(node, {CellEvent::Kind::received, std::uint8_t(port), *r.received});
    flush(node, port);
  }
  void verify(std::size_t node) {
    Cell& c = cells_[node];
    if (c.check == check_word(c.memory)) return;
    unsigned live = 0;
    for (std::size_t p = 0; p < 4; ++p) {
      live |= unsigned(ports_[node][p].end.up()) << p;
      ports_[node][p].pending = 0;
    }
    c.waiting = 0;
    keep(node, restarted(std::uint8_t(live)));
  }
  void happened(std::size_t node, const CellEvent& e) {
    if (node == 0) {
      act([&](auto& out) {
        if (e.kind == CellEvent::Kind::received) root_.received(e.port, e.message, now_, out);
        if (e.kind == CellEvent::Kind::port_up) root_.port_up(e.port, now_);
        if (e.kind == CellEvent::Kind::port_down) root_.port_down(e.port, now_, out);
      });
      return;
    }
    verify(node);
    keep(node, step(cells_[node].memory, e));
  }
  void keep(std::size_t node, const CellStep& s) {
    Cell& c = cells_[node];
    if (c.memory.epoch != s.memory.epoch) c.waiting = 0;  // reports of an older epoch
    c.memory = s.memory;
    c.check = check_word(s.memory);
    for (const auto& item : s.output) {
      CellMessage m = item.message;
      if (c.lie) c.lie(m);
      queue(node, item.port, m);
    }
  }
  template <class Act>
  void act(const Act& what) {
    std::vector<NetworkRoot::Send> out;
    const auto before = root_.state();
    what(out);
    if (before == NetworkRoot::State::exploring && root_.state() == NetworkRoot::State::reporting)
      assigned_ = now_;
    for (const auto& send : out) queue(0, send.port, send.message);
    if (root_.due() && *root_.due() != ticking_) post({ticking_ = *root_.due(), Event::tick});
  }
  void queue(std::size_t node, std::size_t port, const CellMessage& m) {
    ++sent_[std::size_t(m.kind)];
    if (m.kind == CellMessage::Kind::report) {
      Cell& c = cells_[node];
      if (c.waiting < c.reports.size()) c.reports[(c.first + c.waiting++) % c.reports.size()] = m;
    } else {
      Outbox& box = ports_[node][port];
      box.kept[std::size_t(m.kind)] = m;
      box.pending |= 1u << unsigned(m.kind);
    }
    flush(node, port);
  }
  void flush(std::size_t node, std::size_t port) {
    Outbox& box = ports_[node][port];
    if (!box.end.free()) return;
    if (box.pending != 0) {
      unsigned kind = 0;
      while (!(box.pending >> kind & 1)) ++kind;
      box.pending &= ~(1u << kind);
      transmit(node, port, box.end.send(box.kept[kind]));
    } else if (Cell& c = cells_[node]; node > 0 && c.waiting > 0 && c.memory.parent == port) {
      const CellMessage m = c.reports[c.first];
      c.first = (c.first + 1) % c.reports.size();
      --c.waiting;
      transmit(node, port, box.end.send(m));
    } else {
      return;
    }
    arm(node, port);
  }

  SkinTopology topology_;
  Settings s_;
  LinkSettings link_;
  Random random_;
  NetworkRoot root_;
  std::vector<Cell> cells_;
  std::vector<std::vector<Outbox>> ports_;
  std::priority_queue<Event, std::vector<Event>, Later> events_;
  std::vector<FrameBytes> frames_;
  std::vector<std::uint32_t> free_;
  std::array<std::size_t, CellMessage::kinds> sent_{};
  std::uint64_t order_ = 0;
  Nanoseconds now_{0}, ticking_{-1}, assigned_{0};
};

}  // namespace skinctl::testing
