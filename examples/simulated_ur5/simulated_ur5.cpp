#include "examples/simulated_ur5/simulated_ur5.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "examples/adapters/skin/sender.hpp"
#include "examples/adapters/socket.hpp"
#include "examples/simulated_ur5/connection.hpp"
#include "examples/simulated_ur5/primary.hpp"
#include "examples/simulated_ur5/primary_commands.hpp"
#include "examples/simulated_ur5/realtime.hpp"
#include "examples/simulated_ur5/script.hpp"
#include "examples/simulated_ur5/script_sockets.hpp"
#include "examples/simulated_ur5/version.hpp"
#include "examples/support/web_guard.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/hardware/scheduling.hpp"

namespace simulated_ur5 {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using ErrorCode = boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::size_t most_clients = 32;       // per port
constexpr std::size_t rtde_queue = 64 * 1024;  // bytes that a slow reader may leave
constexpr std::size_t rtde_kernel_queue = 32 * 1024;
constexpr std::size_t text_queue = 256 * 1024;
constexpr std::size_t state_queue = 8192;     // above it, states are left out
constexpr std::size_t message_queue = 65536;  // above it, messages
constexpr int most_skipped_in_a_row = 3;

asio::ip::address numeric_address(const std::string& text, const char* what) {
  ErrorCode error;
  const auto address = asio::ip::make_address(text == "localhost" ? "127.0.0.1" : text, error);
  if (error)
    skinctl::refuse(std::string("skinctl: ") + what + " = '" + text + "', allowed: a numeric address");
  return address;
}

}  // namespace

void check(const Config& c) {
  using skinctl::require;
  check(c.controller);
  require(c.speed >= 0 && c.speed <= 1000, "speed", c.speed, "0 (lock-step) to 1000");
  require(c.idle_speed > 0 && c.idle_speed <= 1000, "idle speed", c.idle_speed, "> 0 to 1000");
  require(c.patience > 0 && c.patience <= 3600, "patience", c.patience, "> 0 to 3600 s");
  require(c.skin_loss >= 0 && c.skin_loss <= 1, "skin loss", c.skin_loss, "0 to 1");
  require(c.skin_stop_after >= 0, "skin stop after", c.skin_stop_after, ">= 0 s");
  require(c.quirks.skipped_outputs >= 0 && c.quirks.skipped_outputs <= 0.9, "skipped outputs",
          c.quirks.skipped_outputs, "0 to 0.9");
  require(c.unfinished_time > 0 && c.unfinished_time <= 3600, "unfinished time", c.unfinished_time,
          "> 0 to 3600 s");
  numeric_address(c.address, "address");
  numeric_address(c.skin_host, "skin host");
}

class SimulatedUr5::Network {
 public:
  explicit Network(Config config)
      : config_((check(config), std::move(config))),
        controller_(config_.controller),
        timer_(io_),
        patience_(io_),
        script_sockets_(
            io_, config_.reach_out, [this] { script_heard(); },
            [this](const std::string& text) { log(LogLevel::info, text); }) {
    skin_address_ = numeric_address(config_.skin_host, "skin host");
    skin_port_ = config_.skin_port;
    controller_.on_message = [this](const std::string& text) { log(LogLevel::info, text); };
    controller_.on_notice = [this](const Notice& notice) { announce(notice); };
    controller_.on_skin = [this](Nanoseconds t, const std::vector<SkinSample>& samples) {
      send_skin(t, samples);
    };
  }

  ~Network() { stop(); }

  void start() {
    if (thread_.joinable() || ended_) throw std::logic_error("a simulated UR5 starts once");
    const auto address = numeric_address(config_.address, "address");
    listen(dashboard_, address, config_.ports.dashboard,
           [this](tcp::socket s) { accept_dashboard(std::move(s)); });
    listen(primary_, address, config_.ports.primary,
           [this](tcp::socket s) { accept_script(std::move(s), primary_); });
    listen(secondary_, address, config_.ports.secondary,
           [this](tcp::socket s) { accept_script(std::move(s), secondary_); });
    listen(realtime_, address, config_.ports.realtime,
           [this](tcp::socket s) { accept_script(std::move(s), realtime_); });
    listen(rtde_, address, config_.ports.rtde, [this](tcp::socket s) { accept_rtde(std::move(s)); });
    ports_ = {dashboard_.port, primary_.port, secondary_.port, rtde_.port, realtime_.port};
    next_ = Clock::now();
    schedule(pace());
    thread_ = std::thread([this] {
      if (config_.real_time && !lock_step()) static_cast<void>(skinctl::request_real_time());
      io_.run();
      {
        // Calls that were posted before `ended_` is set still get their answer.
        const std::lock_guard lock(mutex_);
        io_.restart();
        io_.poll();
        ended_ = true;
      }
      ended_condition_.notify_all();
    });
  }

  void stop() {
    if (!thread_.joinable()) return;
    asio::post(io_, [this] { close_all(); });
    thread_.join();
  }

  bool wait(double seconds) {
    std::unique_lock lock(mutex_);
    return ended_condition_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return ended_; });
  }

  Ports ports() const { return ports_; }

  void call(const std::function<void()>& f) {
    std::promise<void> done;
    {
      const std::lock_guard lock(mutex_);
      if (thread_.joinable() && !ended_) {
        asio::post(io_, [&] {
          try {
            f();
            done.set_value();
          } catch (...) {
            done.set_exception(std::current_exception());
          }
        });
      } else {
        f();
        return;
      }
    }
    done.get_future().get();
  }

  Controller& controller() { return controller_; }

  Snapshot snapshot() const {
    Snapshot s;
    s.state = controller_.state();
    s.true_q = controller_.arm().q();
    s.true_dq = controller_.arm().dq();
    s.counters = controller_.counters();
    s.touches = controller_.world().results();
    s.scenario_time = controller_.scenario_time();
    s.contact_force = controller_.world().largest_force();
    s.skin_datagrams = skin_datagrams_;
    s.skin_samples = skin_samples_;
    s.behind = std::chrono::duration<double>(behind_).count();
    return s;
  }

  void set_skin_target(const asio::ip::address& address, std::uint16_t port) {
    skin_address_ = address;
    skin_port_ = port;
    skin_sender_.reset();
  }
  void set_skin_stream(bool on) { skin_on_ = on; }
  const adapters::skin::Picture& lights() const { return lights_; }

 private:
  struct Server {
    std::unique_ptr<tcp::acceptor> acceptor;
    std::uint16_t port = 0;
    std::vector<std::shared_ptr<Connection>> clients;
    std::function<void(tcp::socket)> take;
  };
  struct RtdeClient {
    std::shared_ptr<Connection> connection;
    std::unique_ptr<rtde::Session> session;
    std::uint64_t started = 0;  ///< order in which clients started their streams; 0: not started
  };

  void log(LogLevel level, const std::string& text) const {
    if (config_.log) config_.log(level, text);
  }

  /// Tells every primary client.
  void announce(const Notice& n) {
    if (n.kind != Notice::Kind::safety_mode)
      log(LogLevel::info, n.title + (n.title.empty() ? "" : " ") + n.text);
    std::vector<std::uint8_t> bytes;
    const Nanoseconds now = controller_.now();
    switch (n.kind) {
      case Notice::Kind::text:
        primary::write_text(bytes, n.text, now);
        break;
      case Notice::Kind::key:
        primary::write_key(bytes, n.title, n.text, now);
        break;
      case Notice::Kind::violation:
        primary::write_error(bytes, n.code, n.argument,
                             n.warning ? primary::ReportLevel::warning : primary::ReportLevel::violation,
                             n.text, now);
        break;
      case Notice::Kind::safety_mode:
        write_state(bytes, false);  // who hears of the mode must not find the state before it
        primary::write_safety_mode(bytes, static_cast<SafetyMode>(n.argument), now);
        break;
      case Notice::Kind::exception:
        primary::write_exception(bytes, n.line, n.column, n.text, now);
        break;
      case Notice::Kind::popup:
        primary::write_popup(bytes, n.title, n.text, n.warning, n.error, n.blocking, now);
        break;
    }
    for (const auto& client : std::vector(primary_.clients))
      if (client->is_open() && client->queued() < message_queue) client->send(bytes);
  }

  // ---- servers
  // --------------------------------------------------------------------------------------------------

  void listen(Server& server, const asio::ip::address& address, std::uint16_t port,
              std::function<void(tcp::socket)> take) {
    const tcp::endpoint endpoint(address, port);
    ErrorCode error;
    server.acceptor = std::make_unique<tcp::acceptor>(io_);
    server.acceptor->open(endpoint.protocol(), error);
    if (!error) server.acceptor->set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) server.acceptor->bind(endpoint, error);
    if (!error) server.acceptor->listen(asio::socket_base::max_listen_connections, error);
    if (error)
      throw std::runtime_error("cannot listen on " + config_.address + ":" + std::to_string(port) + ": " +
                               error.message());
    server.port = server.acceptor->local_endpoint().port();
    server.take = std::move(take);
    accept(server);
  }

  void accept(Server& server) {
    server.acceptor->async_accept([this, &server](const ErrorCode& error, tcp::socket socket) {
      if (closing_) return;
      if (!error) {
        std::erase_if(server.clients, [](const auto& c) { return !c->is_open(); });
        if (server.clients.size() < most_clients) {
          server.take(std::move(socket));
        } else {
          log(LogLevel::warning,
              "more than 32 clients on port " + std::to_string(server.port) + ": one turned away");
        }
      } else if (error == asio::error::operation_aborted) {
        return;
      } else {
        // Out of file descriptors, say: try again later rather than spin.
        auto later = std::make_shared<asio::steady_timer>(io_, std::chrono::milliseconds(100));
        later->async_wait([this, &server, later](const ErrorCode&) {
          if (!closing_) accept(server);
        });
        return;
      }
      accept(server);
    });
  }

  std::shared_ptr<Connection> admit(Server& server, tcp::socket socket, std::size_t queue, const char* name) {
    auto connection = std::make_shared<Connection>(std::move(socket), queue);
    server.clients.push_back(connection);
    log(LogLevel::debug, std::string(name) + ": a client came");
    return connection;
  }

  /// Whether the client is a web page: it is told nothing and closed.
  bool web(examples::WebGuard& guard, std::span<const std::uint8_t> bytes, const char* port) {
    const bool refused = guard.refuses(bytes);
    if (refused) log(LogLevel::warning, std::string(port) + ": a web page's request; client closed");
    return refused;
  }

  void accept_dashboard(tcp::socket socket) {
    auto connection = admit(dashboard_, std::move(socket), text_queue, "dashboard");
    auto session = std::make_shared<DashboardSession>(controller_, config_.programs, panel_);
    Connection* raw = connection.get();
    connection->on_bytes = [this, session, raw,
                            guard = examples::WebGuard()](std::span<const std::uint8_t> bytes) mutable {
      if (web(guard, bytes, "dashboard")) return false;
      std::string out;
      const bool stay = session->receive(bytes, out);
      raw->send({reinterpret_cast<const std::uint8_t*>(out.data()), out.size()});
      reconsider();
      if (session->shutdown()) {
        log(LogLevel::info, "shut down by a dashboard client");
        // Let the reply go out first.
        asio::post(io_, [this] { asio::post(io_, [this] { close_all(); }); });
      }
      return stay;
    };
    connection->unfinished = [session] { return session->unfinished(); };
    connection->on_closed = [this](const char* why) {
      log(LogLevel::debug, std::string("dashboard client: ") + why);
    };
    const auto greeting = DashboardSession::greeting;
    connection->send({reinterpret_cast<const std::uint8_t*>(greeting.data()), greeting.size()});
    connection->start();
  }

  /// A client of a port that takes scripts: primary, secondary or realtime.
  void accept_script(tcp::socket socket, Server& server) {
    const char* name = &server == &primary_ ? "primary" : &server == &secondary_ ? "secondary" : "realtime";
    ErrorCode ignored;
    socket.set_option(tcp::socket::send_buffer_size(static_cast<int>(rtde_kernel_queue)), ignored);
    auto connection = admit(server, std::move(socket), text_queue, name);
    auto reader = std::make_shared<ScriptReader>();
    connection->on_bytes = [this, reader, name,
                            guard = examples::WebGuard()](std::span<const std::uint8_t> bytes) mutable {
      if (web(guard, bytes, name)) return false;
      std::vector<std::string> programs;
      const bool readable = reader->feed(bytes, programs);
      for (const std::string& program : programs) {
        if (primary::obey(program, controller_)) continue;
        log(LogLevel::info,
            std::string(name) + ": a program of " + std::to_string(program.size()) + " characters");
        controller_.run(program);
      }
      reconsider();
      if (!readable)
        log(LogLevel::warning, std::string(name) + ": a program of more than 256 KiB; client closed");
      return readable;
    };
    connection->unfinished = [reader] { return reader->unfinished(); };
    connection->on_closed = [this, name](const char* why) {
      log(LogLevel::debug, std::string(name) + " client: " + why);
    };
    std::vector<std::uint8_t> hello;
    if (&server != &realtime_) {
      primary::write_version(hello, controller_.version(), controller_.now());
      write_state(hello, true);
    }
    connection->send(hello);
    connection->start();
  }
  void write_state(std::vector<std::uint8_t>& out, bool first) const {
    primary::write_state(out, controller_.state(), controller_.now(), config_.controller.series, first);
  }

  void accept_rtde(tcp::socket socket) {
    ErrorCode ignored;
    socket.set_option(tcp::socket::send_buffer_size(static_cast<int>(rtde_kernel_queue)), ignored);
    auto connection = admit(rtde_, std::move(socket), rtde_queue, "RTDE");
    auto client = std::make_shared<RtdeClient>();
    client->connection = connection;
    client->session = std::make_unique<rtde::Session>(controller_, owners_, config_.quirks,
                                                      config_.controller.seed + 1000 + ++rtde_count_);
    Connection* raw = connection.get();
    connection->on_bytes = [this, raw, weak = std::weak_ptr(client)](std::span<const std::uint8_t> bytes) {
      const auto self = weak.lock();
      if (!self) return false;
      std::vector<std::uint8_t> out;
      const bool stay = self->session->receive(bytes, out);
      raw->send(out);
      if (!self->session) return false;
      if (!self->session->started())
        self->started = 0;
      else if (self->started == 0)
        self->started = ++start_count_;
      reconsider();
      return stay;
    };
    connection->unfinished = [weak = std::weak_ptr(client)] {
      const auto self = weak.lock();
      return self && self->session && self->session->unfinished();
    };
    connection->on_closed = [this, weak = std::weak_ptr(client)](const char* why) {
      log(LogLevel::info, std::string("RTDE client: ") + why);
      if (const auto self = weak.lock()) {
        self->session.reset();  // its inputs are free again
        self->started = 0;
      }
      reconsider();
    };
    rtde_clients_.push_back(client);
    connection->start();
  }

  // ---- the program's own sockets
  // --------------------------------------------------------------------------------

  /// Something came, opened or closed on a socket of the program.
  void script_heard() {
    impatient_ = false;
    if (!waiting_ || controller_.has_command() || !holds_time()) go_on();
  }

  // ---- time
  // -----------------------------------------------------------------------------------------------------

  bool lock_step() const { return config_.speed == 0; }

  Clock::duration pace() const {
    const double factor = lock_step() ? config_.idle_speed : config_.speed;
    return std::chrono::nanoseconds(
        static_cast<std::int64_t>(static_cast<double>(controller_.cycle()) / factor));
  }

  void schedule(Clock::duration after) {
    next_ += after;
    const auto now = Clock::now();
    if (!lock_step() && controller_.scenario_time() >= 0) behind_ = std::max(behind_, now - next_);
    // Far behind: the host was busy or asleep; that time is gone.
    if (now - next_ > std::chrono::milliseconds(250)) next_ = now;
    timer_.expires_at(next_);
    timer_.async_wait([this](const ErrorCode& stopped) {
      if (!stopped && !closing_) cycle();
    });
  }

  void step_soon() {
    asio::post(io_, [this] {
      if (!closing_) cycle();
    });
  }

  bool someone_streams() const {
    return std::any_of(rtde_clients_.begin(), rtde_clients_.end(),
                       [](const auto& c) { return c->started != 0; });
  }
  /// Lock-step holds the time: a program reads commands, somebody sees the data, and patience has not run
  /// out.
  bool holds_time() const {
    return lock_step() && !impatient_ && controller_.awaits_command() && someone_streams();
  }

  void cycle() {
    controller_.step();
    const bool answered_to = publish(!lock_step() && Clock::now() - next_ > pace());
    script_sockets_.follow(controller_.sockets());
    if (closing_) return;
    if (!holds_time()) {
      if (!controller_.awaits_command()) impatient_ = false;
      schedule(pace());
      return;
    }
    if (controller_.has_command() || !answered_to) {
      step_soon();
      return;
    }
    waiting_ = true;
    patience_.expires_after(std::chrono::nanoseconds(nanoseconds(config_.patience)));
    patience_.async_wait([this](const ErrorCode& stopped) {
      if (stopped || closing_ || !waiting_) return;
      waiting_ = false;
      impatient_ = true;
      log(LogLevel::warning, "no command within the patience of lock-step: simulated time goes on");
      next_ = Clock::now();
      cycle();
    });
  }

  /// Ends the wait of lock-step with the next cycle.
  void go_on() {
    if (!waiting_) return;
    waiting_ = false;
    patience_.cancel();
    next_ = Clock::now();
    step_soon();
  }
  /// Something happened that may make waiting pointless.
  void reconsider() {
    if (waiting_ && !holds_time()) go_on();
  }

  /// Sends this cycle's data packages. True: the client that lock-step follows got one.
  bool publish(bool late) {
    std::erase_if(rtde_clients_, [](const auto& c) { return !c->connection->is_open(); });
    const bool skip = late && skipped_in_a_row_ < most_skipped_in_a_row;
    skipped_in_a_row_ = skip ? skipped_in_a_row_ + 1 : 0;
    RtdeClient* first = nullptr;
    for (const auto& c : rtde_clients_)
      if (c->started != 0 && (!first || c->started < first->started)) first = c.get();
    bool followed_got_one = false;
    for (const auto& c : std::vector(rtde_clients_)) {
      if (!c->session) continue;
      buffer_.clear();
      if (!c->session->publish(buffer_, skip)) continue;
      if (c.get() == first) followed_got_one = true;
      c->connection->send(buffer_);
    }
    send_states();
    return followed_got_one;
  }
  /// The realtime packet of this cycle, and ten times a second a robot state.
  void send_states() {
    const auto send_to = [this](Server& server) {
      for (const auto& c : std::vector(server.clients))
        if (c->is_open() && c->queued() < state_queue) c->send(buffer_);
    };
    if (!realtime_.clients.empty()) {
      buffer_.clear();
      realtime::write_packet(buffer_, controller_.state(), config_.controller.series);
      send_to(realtime_);
    }
    if (++cycles_since_state_ < cycles_per_state()) return;
    cycles_since_state_ = 0;
    buffer_.clear();
    write_state(buffer_, false);
    send_to(primary_);
    send_to(secondary_);
    close_unfinished();
  }
  /// Closes clients that began a message or program and left it at that, and those that do not read.
  void close_unfinished() {
    const auto longest = std::chrono::nanoseconds(nanoseconds(config_.unfinished_time));
    for (Server* server : servers())
      for (const auto& c : std::vector(server->clients)) {
        if (!c->is_open()) continue;
        if (c->stuck(longest))
          c->close("it stopped reading");
        else if (c->unfinished && c->unfinished() && Clock::now() - c->heard_at() > longest)
          c->close("it left a message unfinished");
      }
  }
  std::array<Server*, 5> servers() { return {&dashboard_, &primary_, &secondary_, &rtde_, &realtime_}; }
  std::int64_t cycles_per_state() const { return nanoseconds(0.1) / controller_.cycle(); }

  // ---- skin
  // -----------------------------------------------------------------------------------------------------

  void send_skin(Nanoseconds t, const std::vector<SkinSample>& samples) {
    if (skin_port_ == 0 || !skin_on_ || controller_.skin().cells().empty()) return;
    if (config_.skin_stop_after > 0 && controller_.scenario_time() > config_.skin_stop_after) return;
    // A full or absent receiver loses datagrams; the sequence numbers tell it.
    try {
      if (!skin_sender_) skin_sender_.emplace(skin_address_.to_string(), skin_port_, config_.skin_key);
    } catch (const adapters::ConnectionError& e) {
      log(LogLevel::warning, e.what());
      skin_port_ = 0;
      return;
    }
    const std::chrono::nanoseconds now(t + config_.controller.skin.clock_offset);
    if (config_.skin_loss > 0) {
      send_lossy(samples, now);
    } else {
      skin_datagrams_ += skin_sender_->send(samples, now);
      skin_samples_ += samples.size();
    }
    if (const auto* wanted = skin_sender_->wanted()) lights_ = *wanted, skin_sender_->lights_shown();
  }

  void send_lossy(std::span<const SkinSample> samples, std::chrono::nanoseconds now) {
    constexpr std::size_t full = adapters::skin::max_samples(8);
    do {
      const auto some = samples.first(std::min(samples.size(), full));
      samples = samples.subspan(some.size());
      if (loss_.uniform() < config_.skin_loss) {
        skin_sender_->skip();
        continue;
      }
      skin_datagrams_ += skin_sender_->send(some, now);
      skin_samples_ += some.size();
    } while (!samples.empty());
  }

  void close_all() {
    if (closing_) return;
    closing_ = true;
    ErrorCode ignored;
    timer_.cancel();
    patience_.cancel();
    script_sockets_.close();
    for (Server* server : servers()) {
      if (server->acceptor) server->acceptor->close(ignored);
      for (const auto& c : server->clients) c->close("the controller shut down");
      server->clients.clear();
    }
    skin_sender_.reset();
  }

  Config config_;
  Controller controller_;
  rtde::InputOwners owners_;
  PanelState panel_;
  asio::io_context io_;
  asio::steady_timer timer_, patience_;
  Server dashboard_, primary_, secondary_, rtde_, realtime_;
  Ports ports_;
  std::vector<std::shared_ptr<RtdeClient>> rtde_clients_;
  std::uint64_t rtde_count_ = 0, start_count_ = 0;
  std::vector<std::uint8_t> buffer_;

  ScriptSockets script_sockets_;

  Clock::time_point next_;
  Clock::duration behind_{};
  bool waiting_ = false, impatient_ = false, closing_ = false;
  int skipped_in_a_row_ = 0;
  std::int64_t cycles_since_state_ = 0;

  std::optional<adapters::skin::Sender> skin_sender_;
  adapters::skin::Picture lights_;
  asio::ip::address skin_address_;
  std::uint16_t skin_port_ = 0;
  bool skin_on_ = true;
  Random loss_{7};
  std::uint64_t skin_datagrams_ = 0, skin_samples_ = 0;

  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable ended_condition_;
  bool ended_ = false;
};

SimulatedUr5::SimulatedUr5(Config config) : network_(std::make_unique<Network>(std::move(config))) {}
SimulatedUr5::~SimulatedUr5() = default;
void SimulatedUr5::start() {
  network_->start();
}
void SimulatedUr5::stop() {
  network_->stop();
}
bool SimulatedUr5::wait(double seconds) {
  return network_->wait(seconds);
}
Ports SimulatedUr5::ports() const {
  return network_->ports();
}

Snapshot SimulatedUr5::snapshot() {
  Snapshot s;
  network_->call([&] { s = network_->snapshot(); });
  return s;
}
void SimulatedUr5::call(const std::function<void(Controller&)>& f) {
  network_->call([&] { f(network_->controller()); });
}
void SimulatedUr5::set_skin_target(const std::string& host, std::uint16_t port) {
  const auto address = numeric_address(host, "skin host");
  network_->call([&] { network_->set_skin_target(address, port); });
}
adapters::skin::Picture SimulatedUr5::lights() {
  adapters::skin::Picture out;
  network_->call([&] { out = network_->lights(); });
  return out;
}
void SimulatedUr5::set_skin_stream(bool on) {
  network_->call([&] { network_->set_skin_stream(on); });
}

}  // namespace simulated_ur5
