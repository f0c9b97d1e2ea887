#include "examples/adapters/ros1/subscriber.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "skinctl/core/contract.hpp"

namespace adapters::ros1 {
namespace {

constexpr std::size_t most_visitors = 8, longest_greeting = 65536;
constexpr Timeout patience{2000};  ///< with a visitor that does not finish its request

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}
bool is_name(const std::string& text, bool of_type) {
  const bool begins = of_type ? text.find('/') != std::string::npos : text.starts_with('/');
  return begins && text.size() <= 255 && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                  c == '/';
         });
}

}  // namespace

Subscriber::Subscriber(SubscriberConfig config) : config_(std::move(config)), acceptor_(io_) {
  if (config_.node.empty()) config_.node = "/skinctl_" + std::to_string(::getpid());
  if (!is_name(config_.topic, false))
    skinctl::refuse("ROS 1: topic '" + config_.topic + "', allowed: '/' and letters, digits, _ and /");
  if (!is_name(config_.node, false))
    skinctl::refuse("ROS 1: node '" + config_.node + "', allowed: '/' and letters, digits, _ and /");
  if (!is_name(config_.type, true))
    skinctl::refuse("ROS 1: type '" + config_.type + "', allowed: package/Message");
  const auto master = parse_uri("http://" + config_.master + ":" + std::to_string(config_.port) + "/RPC2");
  if (!master)
    skinctl::refuse("ROS 1: master '" + config_.master + ":" + std::to_string(config_.port) +
                    "', allowed: a host and a port");
  master_ = *master;
  Stream probe;  // the way to the master
  probe.connect(master_.host, master_.port, "the ROS master", config_.timeout);
  master_address_ = probe.remote_address();
  if (config_.address.empty()) config_.address = probe.local_address();
  probe.close();
  acceptor_ = listen(io_, config_.address, 0);
  acceptor_.non_blocking(true);
  here_ = "http://" + config_.address + ":" + std::to_string(acceptor_.local_endpoint().port()) + "/";
  enrol();
}

Subscriber::~Subscriber() {
  try {
    static_cast<void>(
        ask(master_, "the ROS master",
            {"unregisterSubscriber",
             {Value::of(std::string_view(config_.node)), Value::of(std::string_view(config_.topic)),
              Value::of(std::string_view(here_))}}));
  } catch (const ConnectionError&) {  // it has gone first
  }
}

Value Subscriber::ask(const Uri& who, const std::string& name, const Call& call) const {
  const auto deadline = Clock::now() + config_.timeout;
  Stream stream;
  stream.connect(who.host, who.port, name, config_.timeout);
  const std::string what = name + " at " + who.host + ":" + std::to_string(who.port);
  const std::string host = who.host + ":" + std::to_string(who.port);
  if (!stream.write(bytes_of(http_request(host, who.path, write(call))), left_until(deadline)))
    throw ConnectionError(what + " hung up");
  HttpMessage message(HttpMessage::Kind::answer);
  auto state = HttpMessage::State::unfinished;
  std::array<std::uint8_t, 4096> block;
  while (state == HttpMessage::State::unfinished) {
    std::size_t count = 0;
    const Read read = stream.read_some(block, count, left_until(deadline));
    if (read == Read::nothing) throw ConnectionError(what + " gave no answer to " + call.method);
    state = read == Read::closed ? message.closed() : message.take({block.data(), count});
  }
  auto answer = state == HttpMessage::State::whole ? parse_answer(message.body()) : std::nullopt;
  if (!answer) throw ConnectionError(what + " gave no proper answer to " + call.method);
  return std::move(*answer);
}

/// Answers are [code, words, value]; code 1 is success.
Value Subscriber::succeed(const Uri& who, const std::string& name, const Call& call) const {
  Value answer = ask(who, name, call);
  if (answer.items.size() != 3 || answer.items[0].kind != Value::Kind::number ||
      answer.items[0].number != 1) {
    std::string words = answer.items.size() > 1 ? answer.items[1].text.substr(0, 200) : "no list of three";
    for (char& c : words)
      if (c < 0x20 || c > 0x7e) c = '?';  // it will be printed
    throw ConnectionError(name + " refuses " + call.method + ": " + words);
  }
  return std::move(answer.items[2]);
}

void Subscriber::enrol() {
  heard_at_ = Clock::now();
  set_publishers(
      succeed(master_, "the ROS master",
              {"registerSubscriber",
               {Value::of(std::string_view(config_.node)), Value::of(std::string_view(config_.topic)),
                Value::of(std::string_view(config_.type)), Value::of(std::string_view(here_))}}));
}

void Subscriber::set_publishers(const Value& uris) {
  for (auto& p : publishers_) p->gone = true;
  for (const Value& item : uris.items) {
    const auto known = std::find_if(publishers_.begin(), publishers_.end(),
                                    [&](const auto& p) { return p->uri == item.text; });
    if (known != publishers_.end()) {
      (*known)->gone = false;
      continue;
    }
    if (publishers_.size() >= 2 * config_.most_publishers || !parse_uri(item.text)) {
      trouble_ = "the ROS master names a publisher that is no address, or too many";
      continue;
    }
    publishers_.push_back(std::make_unique<Publisher>(item.text));
  }
  // Those that have gone are closed here; their places stay until the others' numbers may change: when nobody
  // is heard.
  for (auto& p : publishers_)
    if (p->gone) p->stream.close();
  if (connected() == 0) std::erase_if(publishers_, [](const auto& p) { return p->gone; });
}

void Subscriber::connect(Publisher& p) {
  p.at = Clock::now() + config_.again;
  try {
    const auto uri = parse_uri(p.uri);
    const Value way =
        succeed(*uri, "the publisher",
                {"requestTopic",
                 {Value::of(std::string_view(config_.node)), Value::of(std::string_view(config_.topic)),
                  Value::of(std::vector{Value::of(std::vector{Value::of(std::string_view("TCPROS"))})})}});
    const bool three = way.items.size() == 3 && way.items[0].text == "TCPROS" &&
                       way.items[2].kind == Value::Kind::number && way.items[2].number > 0 &&
                       way.items[2].number < 65536;
    const auto place =
        three ? parse_uri("http://" + way.items[1].text + ":" + std::to_string(way.items[2].number))
              : std::nullopt;
    if (!place) throw ConnectionError("the publisher at " + p.uri + " offers no TCPROS");
    p.stream.connect(place->host, place->port, "the publisher's stream", config_.timeout);
    p.blocks = Blocks(longest_greeting);
    p.greeted = false;
    if (!p.stream.write(header({{"callerid", config_.node},
                                {"md5sum", config_.md5},
                                {"tcp_nodelay", "1"},
                                {"topic", config_.topic},
                                {"type", config_.type}}),
                        config_.timeout))
      throw ConnectionError("the publisher at " + p.uri + " hung up");
  } catch (const ConnectionError& e) {
    lose(p, e.what());
  }
}

void Subscriber::lose(Publisher& p, const std::string& why) {
  p.stream.close();
  p.at = Clock::now() + config_.again;
  trouble_ = why;
}

void Subscriber::read(std::size_t index, const Take& take) {
  Publisher& p = *publishers_[index];
  std::array<std::uint8_t, 65536> block;
  for (int k = 0; k < 64; ++k) {
    std::size_t count = 0;
    const Read read = p.stream.read_some(block, count, Timeout(0));
    if (read == Read::closed) return lose(p, "the publisher at " + p.uri + " hung up");
    if (read == Read::nothing) break;
    p.blocks.add({block.data(), count});
    while (const auto message = p.blocks.next()) {
      if (p.greeted) {
        heard_at_ = Clock::now();
        take(index, *message);
        continue;
      }
      const auto fields = parse_fields(*message);
      const auto says = [&](const char* name) {
        const auto at = fields->find(name);
        return at == fields->end() ? std::string() : at->second.substr(0, 200);
      };
      if (!fields) return lose(p, "the publisher at " + p.uri + " begins with nonsense");
      if (const std::string error = says("error"); !error.empty())
        return lose(p, "the publisher at " + p.uri + " refuses: " + error);
      if (says("md5sum") != config_.md5)
        return lose(p, "the publisher at " + p.uri + " sends " + says("type") + " with the sum " +
                           says("md5sum") + " instead of " + config_.md5);
      p.greeted = true;
      trouble_.clear();
      const auto rest = std::move(p.blocks);  // what came with the header, under the limit for messages
      p.blocks = Blocks(config_.largest);
      p.blocks.add(rest.rest());
    }
    if (p.blocks.broken()) return lose(p, "the publisher at " + p.uri + " announces too long a message");
    p.blocks.drop();
  }
}

void Subscriber::wait(Timeout timeout) {
  std::vector<pollfd> watched{{acceptor_.native_handle(), POLLIN, 0}};
  for (const auto& v : visitors_) watched.push_back({v->stream.handle(), POLLIN, 0});
  for (const auto& p : publishers_)
    if (p->stream.is_open()) watched.push_back({p->stream.handle(), POLLIN, 0});
  static_cast<void>(::poll(watched.data(), watched.size(), static_cast<int>(timeout.count())));
}

void Subscriber::poll(Timeout timeout, const Take& take) {
  wait(timeout);
  serve();
  const auto now = Clock::now();
  std::size_t open = connected();
  for (std::size_t i = 0; i < publishers_.size(); ++i) {
    Publisher& p = *publishers_[i];
    if (p.gone) continue;
    if (!p.stream.is_open() && now >= p.at && open < config_.most_publishers) {
      connect(p);
      open += p.stream.is_open();
    }
    if (p.stream.is_open()) read(i, take);
    // A header that does not come holds nobody.
    if (p.stream.is_open() && !p.greeted && Clock::now() >= p.at + config_.timeout)
      lose(p, "the publisher at " + p.uri + " does not say what it sends");
  }
  if (now - heard_at_ > config_.anew) {
    try {
      enrol();
    } catch (const ConnectionError& e) {
      trouble_ = e.what();
    }
  }
}

std::size_t Subscriber::connected() const noexcept {
  return static_cast<std::size_t>(std::count_if(publishers_.begin(), publishers_.end(),
                                                [](const auto& p) { return p->stream.is_open(); }));
}

void Subscriber::serve() {
  for (std::size_t k = 0; k < most_visitors; ++k) {
    auto v = std::make_unique<Visitor>();
    if (!v->stream.accept_waiting(acceptor_)) break;
    if (v->stream.remote_address() != master_address_ || visitors_.size() >= most_visitors) continue;
    v->until = Clock::now() + patience;
    visitors_.push_back(std::move(v));
  }
  std::erase_if(visitors_, [&](auto& v) {
    std::array<std::uint8_t, 4096> block;
    for (int k = 0; k < 32; ++k) {
      std::size_t count = 0;
      const Read read = v->stream.read_some(block, count, Timeout(0));
      if (read == Read::closed) return true;
      if (read == Read::nothing) break;
      const auto state = v->request.take({block.data(), count});
      if (state == HttpMessage::State::broken) return true;
      if (state == HttpMessage::State::whole) {
        static_cast<void>(v->stream.write(bytes_of(http_answer(answer(v->request.body()))), Timeout(100)));
        return true;
      }
    }
    return Clock::now() >= v->until;
  });
}

/// To the calls that a master makes, and to those that ROS's tools ask any node.
std::string Subscriber::answer(const std::string& body) {
  const auto say = [](std::int64_t code, std::string_view words, Value value) {
    return write(Value::of(std::vector{Value::of(code), Value::of(words), std::move(value)}));
  };
  const auto call = parse_call(body);
  if (!call) return say(-1, "no call", Value::of(std::int64_t{0}));
  const auto& given = call->parameters;
  if (call->method == "publisherUpdate") {
    if (given.size() != 3 || given[2].kind != Value::Kind::list)
      return say(-1, "publisherUpdate(caller, topic, publishers)", Value::of(std::int64_t{0}));
    if (given[1].text == config_.topic) set_publishers(given[2]);
    return say(1, "", Value::of(std::int64_t{0}));
  }
  if (call->method == "shutdown") {
    dismissed_ = true;
    return say(1, "", Value::of(std::int64_t{0}));
  }
  if (call->method == "getPid") return say(1, "", Value::of(std::int64_t{::getpid()}));
  if (call->method == "getSubscriptions")
    return say(1, "",
               Value::of(std::vector{Value::of(std::vector{Value::of(std::string_view(config_.topic)),
                                                           Value::of(std::string_view(config_.type))})}));
  if (call->method == "getPublications") return say(1, "", Value::of(std::vector<Value>{}));
  return say(-1, "this node has no such call", Value::of(std::int64_t{0}));
}

}  // namespace adapters::ros1
