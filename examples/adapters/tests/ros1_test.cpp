// A subscriber to ROS 1: what masters and publishers say to it, and what enemies say.
//
// Promise: a skin that is published in ROS 1 is heard, and whoever else talks to the subscriber changes
// nothing
// Tried: a master and a publisher whose bytes are written by hand, whole, in single bytes, in bursts,
// lost and found again; wrong sums, refusals, headers and lengths that lie, silent visitors; ROS's own
// master and publisher (rospy, where installed): 100 of 100 messages. Also: `examples/skin_bridge/tests/`

#include "examples/adapters/skin/ros1.hpp"

#include <doctest/doctest.h>

#include <random>

#include "examples/adapters/ros1/subscriber.hpp"
#include "examples/adapters/tests/ros1_peer.hpp"
#include "skinctl/core/contract.hpp"

using namespace adapters;
using namespace adapters::ros1;
using namespace std::chrono_literals;

namespace {

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}
SubscriberConfig config_for(const ros1_peer::Peer& peer) {
  return {.master = "127.0.0.1",
          .port = peer.master_port(),
          .topic = "/arm/skin",
          .type = skin::skin_message_type,
          .md5 = skin::skin_message_md5,
          .node = "/under_test",
          .address = "",
          .timeout = Timeout(200),
          .again = Timeout(20),
          .anew = Timeout(60000)};
}
/// Polls until `done`, 5 s at most.
template <class Done>
bool poll_until(Subscriber& node, const Subscriber::Take& take, Done&& done) {
  for (const auto start = std::chrono::steady_clock::now(); std::chrono::steady_clock::now() - start < 5s;) {
    if (done()) return true;
    node.poll(Timeout(2), take);
  }
  return done();
}
const Subscriber::Take ignore = [](std::size_t, std::span<const std::uint8_t>) {};

}  // namespace

TEST_CASE("XML-RPC: what roscpp and rospy write is read; what is written is read back") {
  const auto answer = parse_answer(
      "<?xml "
      "version=\"1.0\"?>\r\n<methodResponse><params><param>\r\n\t<value><array><data><value><i4>1</i4></"
      "value><value>it's "
      "&lt;on&gt; &amp; "
      "&#65;&#x42;</value><value><array><data/></array></value><value/><value><string/></value>"
      "<value><boolean>1</boolean></value><value><double>2.5</double></value><value><struct><member><name>a</"
      "name><value>"
      "<int> -7 </int></value></member></struct></value><!-- > "
      "--></data></array></value>\r\n</param></params></methodResponse>\r\n");
  REQUIRE(answer);
  REQUIRE(answer->items.size() == 8);
  CHECK(answer->items[0] == Value::of(std::int64_t{1}));
  CHECK(answer->items[1].text == "it's <on> & AB");
  CHECK(answer->items[2] == Value::of(std::vector<Value>{}));
  CHECK(answer->items[3] == Value::of(""));
  CHECK(answer->items[4] == Value::of(""));
  CHECK(answer->items[5].number == 1);
  CHECK(answer->items[6].text == "2.5");
  CHECK(answer->items[7].items.at(0).number == -7);
  const Call call{
      "requestTopic",
      {Value::of("/a <&> b"), Value::of(std::vector{Value::of(std::vector{Value::of("TCPROS")})})}};
  const auto again = parse_call(write(call));
  REQUIRE(again);
  CHECK(again->method == call.method);
  CHECK(again->parameters == call.parameters);
  CHECK(parse_answer(write(*answer)) == answer);
}

TEST_CASE("XML-RPC: faults, unfinished and hostile texts are refused") {
  const std::string good = write(Value::of(std::vector{Value::of(std::int64_t{1}), Value::of("x")}));
  for (std::size_t n = 0; n + 1 < good.size(); ++n)
    CHECK_FALSE(parse_answer(std::string_view(good).substr(0, n)));
  for (const char* wrong :
       {"<methodResponse><fault><value><int>4</int></value></fault></methodResponse>",
        "<!DOCTYPE x [<!ENTITY a "
        "\"b\">]><methodResponse><params><param><value>&a;</value></param></params></methodResponse>",
        "<methodResponse><params><param><value>&a;</value></param></params></methodResponse>",
        "<methodResponse><params><param><value><i4>1e3</i4></value></param></params></methodResponse>",
        "<methodResponse><params><param><value><i4>99999999999999999999</i4></value></param></params></"
        "methodResponse>",
        "<methodResponse><params><param><value><string>a</i4></value></param></params></methodResponse>",
        "<methodCall><methodName>x</methodName></methodCall>"})
    CHECK_FALSE(parse_answer(wrong));
  const auto nested = [](std::size_t depth) {
    std::string open, close;
    for (std::size_t k = 0; k < depth; ++k)
      open += "<value><array><data>", close += "</data></array></value>";
    return "<methodResponse><params><param>" + open + close + "</param></params></methodResponse>";
  };
  CHECK(parse_answer(nested(deepest)));
  CHECK_FALSE(parse_answer(nested(deepest + 1)));
  CHECK_FALSE(parse_answer(nested(100000)));
  const auto many = [](std::size_t n) {
    std::string items;
    for (std::size_t k = 0; k < n; ++k) items += "<value/>";
    return "<methodResponse><params><param><value><array><data>" + items +
           "</data></array></value></param></params></methodResponse>";
  };
  CHECK(parse_answer(many(max_values - 1)));
  CHECK_FALSE(parse_answer(many(max_values)));
}

TEST_CASE("HTTP: answers in pieces, without a length, too long, of errors; addresses of nodes") {
  const std::string answer = http_answer("<hello/>");
  for (const std::size_t piece : {1u, 7u, 1000u}) {
    HttpMessage m(HttpMessage::Kind::answer);
    auto state = HttpMessage::State::unfinished;
    for (std::size_t at = 0; at < answer.size(); at += piece) {
      CHECK(state == HttpMessage::State::unfinished);
      state = m.take(bytes_of(answer.substr(at, piece)));
    }
    CHECK(state == HttpMessage::State::whole);
    CHECK(m.body() == "<hello/>");
  }
  HttpMessage open(HttpMessage::Kind::answer);
  CHECK(open.take(bytes_of("HTTP/1.0 200 OK\r\n\r\nabc")) == HttpMessage::State::unfinished);
  CHECK(open.closed() == HttpMessage::State::whole);
  CHECK(open.body() == "abc");
  HttpMessage cut(HttpMessage::Kind::answer);
  static_cast<void>(cut.take(bytes_of(answer.substr(0, answer.size() - 1))));
  CHECK(cut.closed() == HttpMessage::State::broken);
  for (const char* begun : {"", "H", "HTTP/1.1 200 OK\r\nContent-"}) {  // a peer that hangs up
    HttpMessage m(HttpMessage::Kind::answer);
    static_cast<void>(m.take(bytes_of(begun)));
    CHECK(m.closed() == HttpMessage::State::broken);
    CHECK(m.take(bytes_of("HTTP/1.1 200 OK\r\n\r\n")) == HttpMessage::State::broken);
  }
  HttpMessage request(HttpMessage::Kind::request);
  CHECK(request.take(bytes_of(http_request("h:1", "/RPC2", "x"))) == HttpMessage::State::whole);
  for (const std::string& wrong :
       {std::string("HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n"), std::string("SSH-2.0\r\n\r\n"),
        std::string("HTTP/1.1 200 OK\r\nContent-Length: 99999999\r\n\r\n"),
        "HTTP/1.1 200 OK\r\nx: " + std::string(100000, 'x')}) {
    HttpMessage m(HttpMessage::Kind::answer);
    CHECK(m.take(bytes_of(wrong)) == HttpMessage::State::broken);
  }
  const auto uri = parse_uri("http://robot-1.local:41235/RPC2");
  REQUIRE(uri);
  CHECK(uri->host == "robot-1.local");
  CHECK(uri->port == 41235);
  CHECK(uri->path == "/RPC2");
  CHECK(parse_uri("http://a:1")->path == "/");
  for (const char* wrong :
       {"", "http://", "http://a", "http://a:", "http://a:0/", "http://a:65536/", "http://a:1x/",
        "http://:1/", "https://a:1/", "http://a b:1/", "http://a:1/\r\nx", "http://a@b:1/"})
    CHECK_FALSE(parse_uri(wrong));
}

TEST_CASE("TCPROS: headers and blocks, in any pieces; lengths that lie") {
  const Fields fields{{"callerid", "/a"}, {"type", "b/C"}, {"empty", ""}, {"x", "1=2"}};
  const auto bytes = header(fields);
  CHECK(bytes[0] == bytes.size() - 4);
  CHECK(parse_fields(std::span(bytes).subspan(4)) == fields);
  for (std::size_t n = 5; n < bytes.size(); ++n) {
    const auto cut = parse_fields(std::span(bytes).subspan(4, n - 4));
    if (cut) CHECK(cut->size() < fields.size());
  }
  for (const std::vector<std::uint8_t>& wrong : {std::vector<std::uint8_t>{1},
                                                 {255, 255, 255, 255},
                                                 {3, 0, 0, 0, 'a', 'b', 'c'},
                                                 {2, 0, 0, 0, '=', 'b'}})
    CHECK_FALSE(parse_fields(wrong));
  std::mt19937 rng(1);
  for (int round = 0; round < 50; ++round) {
    Blocks blocks(300);
    std::vector<std::uint8_t> stream;
    std::vector<std::size_t> sizes, got;
    for (int k = 0; k < 20; ++k) {
      sizes.push_back(rng() % 301);
      stream.push_back(static_cast<std::uint8_t>(sizes.back())),
          stream.push_back(static_cast<std::uint8_t>(sizes.back() >> 8));
      stream.insert(stream.end(), 2, 0);
      stream.insert(stream.end(), sizes.back(), static_cast<std::uint8_t>(k));
    }
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t n = std::min<std::size_t>(1 + rng() % 400, stream.size() - at);
      blocks.add(std::span(stream).subspan(at, n));
      at += n;
      while (const auto block = blocks.next()) {
        CHECK(std::all_of(block->begin(), block->end(), [&](std::uint8_t b) { return b == got.size(); }));
        got.push_back(block->size());
      }
      blocks.drop();
    }
    CHECK(got == sizes);
    CHECK_FALSE(blocks.broken());
  }
  Blocks blocks(300);
  blocks.add(std::vector<std::uint8_t>{45, 1, 0, 0});  // 301
  CHECK_FALSE(blocks.next());
  CHECK(blocks.broken());
}

TEST_SUITE_BEGIN("real time");

TEST_CASE(
    "ROS 1: registers, hears a publisher in whole and in single bytes, follows it when it comes, goes and "
    "comes back") {
  ros1_peer::Peer peer("/arm/skin");
  peer.lists_publisher = false;
  std::vector<skinctl::CellSample> sent(3), heard;
  for (std::uint32_t i = 0; i < 3; ++i) sent[i].cell = i + 7, sent[i].force[0] = 0.25f;
  const auto message = skin::ros1_message(sent);
  {
    Subscriber node(config_for(peer));
    CHECK(peer.calls() == "registerSubscriber ");
    int messages = 0;
    const Subscriber::Take take = [&](std::size_t, std::span<const std::uint8_t> bytes) {
      heard.clear();
      CHECK(skin::parse_ros1(bytes, heard));
      ++messages;
    };
    CHECK(node.connected() == 0);
    std::string said;
    std::thread master([&] { said = peer.update({peer.publisher_uri()}); });
    CHECK(poll_until(node, take, [&] { return peer.streams() == 1; }));
    master.join();
    CHECK(said.find("<int>1</int>") != std::string::npos);
    peer.publish(message);
    CHECK(poll_until(node, take, [&] { return messages == 1; }));
    REQUIRE(heard.size() == 3);
    CHECK(heard[2].cell == 9);
    CHECK(heard[2].force[0] == 0.25f);
    peer.byte_by_byte = true;
    peer.publish(message);
    CHECK(poll_until(node, take, [&] { return messages == 2; }));
    peer.byte_by_byte = false;
    std::string burst;
    for (int k = 0; k < 200; ++k) burst += ros1_peer::field(std::string(message.begin(), message.end()));
    peer.send(burst);
    CHECK(poll_until(node, take, [&] { return messages == 202; }));
    peer.hang_up();  // and is found again
    CHECK(poll_until(node, take, [&] { return peer.streams() == 1; }));
    peer.publish(message);
    CHECK(poll_until(node, take, [&] { return messages == 203; }));
    std::thread leaves([&] { peer.update({}); });
    CHECK(poll_until(node, take, [&] { return node.connected() == 0; }));
    leaves.join();
    std::thread asks([&] {
      CHECK(peer.call_subscriber("getPid", "").find(std::to_string(::getpid())) != std::string::npos);
      CHECK(peer.call_subscriber("noSuchCall", "").find("<int>-1</int>") != std::string::npos);
      peer.call_subscriber("shutdown",
                           "<param><value>/master</value></param><param><value>new node</value></param>");
    });
    CHECK(poll_until(node, take, [&] { return node.dismissed(); }));
    asks.join();
  }
  CHECK(peer.calls().ends_with("unregisterSubscriber "));
}

TEST_CASE("ROS 1: what a publisher does wrong has words, and holds nobody") {
  struct Case {
    const char* words;
    void (*arrange)(ros1_peer::Peer&);
    std::string bytes{};
  };
  const Case cases[] = {
      {"with the sum 00000000", [](ros1_peer::Peer& p) { p.wrong_sum = true; }},
      {"refuses requestTopic: no protocol", [](ros1_peer::Peer& p) { p.refuses_stream = true; }},
      {"gave no answer to requestTopic", [](ros1_peer::Peer& p) { p.silent_publisher = true; }},
      {"too long a message", [](ros1_peer::Peer&) {}, "\xff\xff\xff\x7f"},
  };
  for (const Case& c : cases) {
    CAPTURE(c.words);
    ros1_peer::Peer peer("/arm/skin");
    c.arrange(peer);
    Subscriber node(config_for(peer));
    CHECK(poll_until(node, ignore, [&] {
      if (!c.bytes.empty() && peer.streams() > 0) peer.send(c.bytes);
      return node.trouble().find(c.words) != std::string::npos;
    }));
    CHECK_MESSAGE(node.trouble().find(c.words) != std::string::npos, node.trouble());
  }
  ros1_peer::Peer peer("/other");  // a publisher's own words, in its header
  Subscriber node(config_for(peer));
  CHECK(poll_until(node, ignore, [&] {
    return node.trouble().find("refuses: topic /arm/skin is not published") != std::string::npos;
  }));
}

TEST_CASE("ROS 1: no master, one that refuses, names that are none") {
  ros1_peer::Peer peer("/arm/skin");
  peer.master_refuses = true;
  CHECK_THROWS_WITH_AS(Subscriber(config_for(peer)),
                       "the ROS master refuses registerSubscriber: topic is not ? <welcome>",
                       ConnectionError);
  auto nobody = config_for(peer);
  nobody.port = 1;
  CHECK_THROWS_AS(Subscriber{nobody}, ConnectionError);
  for (const char* topic : {"", "skin", "/skin<", "/a b"}) {
    auto wrong = config_for(peer);
    wrong.topic = topic;
    CHECK_THROWS_WITH_AS(Subscriber{wrong}, doctest::Contains("ROS 1: topic '"), skinctl::ConfigurationError);
  }
}

TEST_CASE(
    "ROS 1: visitors that say nothing, or nonsense, or too much, do not keep the subscriber from listening") {
  ros1_peer::Peer peer("/arm/skin");
  Subscriber node(config_for(peer));
  int messages = 0;
  const Subscriber::Take take = [&](std::size_t, std::span<const std::uint8_t>) { ++messages; };
  CHECK(poll_until(node, take, [&] { return peer.streams() == 1; }));
  boost::asio::io_context io;
  std::vector<boost::asio::ip::tcp::socket> visitors;
  for (int k = 0; k < 20; ++k) {
    visitors.emplace_back(io);
    boost::system::error_code error;
    visitors.back().connect({boost::asio::ip::address_v4::loopback(), peer.subscriber_port()}, error);
    const std::string junk = k % 2 == 0 ? std::string(std::size_t(k) * 10000, 'x') : std::string();
    boost::asio::write(visitors.back(), boost::asio::buffer(junk), error);
    node.poll(Timeout(0), take);
  }
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < 20; ++k) {
    peer.publish(skin::ros1_message({}));
    node.poll(Timeout(5), take);
  }
  CHECK(poll_until(node, take, [&] { return messages == 20; }));
  CHECK(std::chrono::steady_clock::now() - start < 1s);
}

TEST_SUITE_END();
