#include "examples/adapters/ros1/xml_rpc.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

namespace adapters::ros1 {
namespace {

constexpr std::size_t longest_header = 8192, longest_body = 65536;

bool blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// Goes through tags and the texts between them. Once something is wrong it stays so.
class Reader {
 public:
  explicit Reader(std::string_view xml) : rest_(xml) {}

  /// Whether the next tag is `name`, and goes behind it: "x", "/x" or "x/" (attributes are passed over).
  bool open(std::string_view name) { return look() && !closing_ && name_ == name && step(); }
  bool close(std::string_view name) { return look() && closing_ && name_ == name && step(); }
  /// An element that was opened as "x/": its end has been read with it.
  [[nodiscard]] bool was_empty() const { return was_empty_; }
  /// The text before the next tag, `&lt;` and the like replaced.
  const std::string& text() {
    look();
    return text_;
  }
  [[nodiscard]] bool good() const { return good_; }
  bool fail() { return good_ = false; }

 private:
  bool step() {
    seen_ = false;
    was_empty_ = empty_;
    return true;
  }
  /// The next tag into `name_`, what stands before it into `text_`.
  bool look() {
    if (seen_ || !good_) return good_;
    text_.clear();
    for (;;) {
      const auto at = rest_.find('<');
      if (at == std::string_view::npos || !append(rest_.substr(0, at))) return fail();
      rest_.remove_prefix(at + 1);
      if (rest_.starts_with('?')) {
        if (!skip("?>")) return fail();
      } else if (rest_.starts_with("!--")) {
        if (!skip("-->")) return fail();
      } else {
        break;
      }
    }
    const auto end = rest_.find('>');
    if (end == std::string_view::npos || rest_.starts_with('!')) return fail();  // no DOCTYPE, no CDATA
    std::string_view tag = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    closing_ = tag.starts_with('/');
    empty_ = !closing_ && tag.ends_with('/');
    if (closing_) tag.remove_prefix(1);
    if (empty_) tag.remove_suffix(1);
    name_ = tag.substr(0, std::min(tag.find_first_of(" \t\r\n"), tag.size()));
    seen_ = true;
    return true;
  }
  bool skip(std::string_view mark) {
    const auto at = rest_.find(mark);
    if (at == std::string_view::npos) return false;
    rest_.remove_prefix(at + mark.size());
    return true;
  }
  bool append(std::string_view raw) {
    while (!raw.empty()) {
      const auto at = std::min(raw.find('&'), raw.size());
      text_ += raw.substr(0, at);
      raw.remove_prefix(at);
      if (raw.empty()) return true;
      const auto end = raw.substr(0, 12).find(';');
      if (end == std::string_view::npos || !entity(raw.substr(1, end - 1))) return false;
      raw.remove_prefix(end + 1);
    }
    return true;
  }
  bool entity(std::string_view name) {
    constexpr std::pair<std::string_view, char> known[] = {
        {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
    for (const auto& [word, c] : known)
      if (name == word) {
        text_ += c;
        return true;
      }
    if (!name.starts_with('#')) return false;
    name.remove_prefix(1);
    const bool hexadecimal = name.starts_with('x');
    if (hexadecimal) name.remove_prefix(1);
    unsigned code = 0;
    const auto [end, error] =
        std::from_chars(name.data(), name.data() + name.size(), code, hexadecimal ? 16 : 10);
    if (error != std::errc() || end != name.data() + name.size()) return false;
    text_ += code < 0x80 ? static_cast<char>(code) : '?';  // names and addresses are ASCII
    return true;
  }

  std::string_view rest_, name_;
  std::string text_;
  bool closing_ = false, empty_ = false, was_empty_ = false, seen_ = false, good_ = true;
};

bool number(std::string_view text, std::int64_t& into) {
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), into);
  return error == std::errc() && end == text.data() + text.size();
}

class Values {
 public:
  explicit Values(Reader& in) : in_(in) {}

  /// What is between <value> and </value>; <value> has been read.
  bool rest_of_value(Value& v, std::size_t depth) {
    if (depth > deepest || ++count_ > max_values) return in_.fail();
    if (in_.was_empty()) return true;
    if (in_.close("value")) {  // a text without a type
      v.text = last_text_;
      return true;
    }
    return in_.good() && typed(v, depth) && in_.close("value");
  }
  bool open_value() { return in_.open("value") && remember(); }

 private:
  bool remember() {
    if (!in_.was_empty()) last_text_ = in_.text();
    return true;
  }
  bool typed(Value& v, std::size_t depth) {
    for (const char* word : {"string", "double", "dateTime.iso8601", "base64", "nil"})
      if (in_.open(word)) return scalar(v, word);
    for (const char* word : {"i4", "int", "i8", "boolean"})
      if (in_.open(word)) {
        v.kind = Value::Kind::number;
        return scalar(v, word) && number(std::exchange(v.text, {}), v.number);
      }
    v.kind = Value::Kind::list;
    if (in_.open("array")) {
      if (!in_.open("data")) return false;
      if (in_.was_empty()) return in_.close("array");
      while (open_value())
        if (!rest_of_value(v.items.emplace_back(), depth + 1)) return false;
      return in_.close("data") && in_.close("array");
    }
    if (!in_.open("struct")) return false;
    if (in_.was_empty()) return true;
    while (in_.open("member")) {
      if (!in_.open("name") || in_.was_empty() || !in_.close("name") || !open_value() ||
          !rest_of_value(v.items.emplace_back(), depth + 1) || !in_.close("member"))
        return false;
    }
    return in_.close("struct");
  }
  bool scalar(Value& v, const char* word) {
    if (in_.was_empty()) return true;
    v.text = in_.text();
    return in_.close(word);
  }

  Reader& in_;
  std::string last_text_;
  std::size_t count_ = 0;
};

void escape(std::string& out, std::string_view text) {
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
}
void append(std::string& out, const Value& v) {
  out += "<value>";
  if (v.kind == Value::Kind::text) {
    out += "<string>";
    escape(out, v.text);
    out += "</string>";
  } else if (v.kind == Value::Kind::number) {
    out += "<int>" + std::to_string(v.number) + "</int>";
  } else {
    out += "<array><data>";
    for (const Value& item : v.items) append(out, item);
    out += "</data></array>";
  }
  out += "</value>";
}

}  // namespace

Value Value::of(std::string_view text) {
  return {.kind = Kind::text, .text = std::string(text)};
}
Value Value::of(std::int64_t number) {
  return {.kind = Kind::number, .number = number};
}
Value Value::of(std::vector<Value> items) {
  return {.kind = Kind::list, .items = std::move(items)};
}

std::optional<Call> parse_call(std::string_view xml) {
  Reader in(xml);
  Values values(in);
  Call call;
  if (!in.open("methodCall") || in.was_empty() || !in.open("methodName") || in.was_empty())
    return std::nullopt;
  call.method = in.text();
  if (!in.close("methodName")) return std::nullopt;
  if (in.open("params") && !in.was_empty()) {
    while (in.open("param"))
      if (in.was_empty() || !values.open_value() ||
          !values.rest_of_value(call.parameters.emplace_back(), 1) || !in.close("param"))
        return std::nullopt;
    if (!in.close("params")) return std::nullopt;
  }
  if (!in.close("methodCall")) return std::nullopt;
  return call;
}

std::optional<Value> parse_answer(std::string_view xml) {
  Reader in(xml);
  Values values(in);
  Value v;
  for (const char* word : {"methodResponse", "params", "param"})
    if (!in.open(word) || in.was_empty()) return std::nullopt;
  if (!values.open_value() || !values.rest_of_value(v, 1)) return std::nullopt;
  for (const char* word : {"param", "params", "methodResponse"})
    if (!in.close(word)) return std::nullopt;
  return v;
}

std::string write(const Call& call) {
  std::string out = "<?xml version=\"1.0\"?>\n<methodCall><methodName>";
  escape(out, call.method);
  out += "</methodName><params>";
  for (const Value& v : call.parameters) {
    out += "<param>";
    append(out, v);
    out += "</param>";
  }
  return out + "</params></methodCall>\n";
}
std::string write(const Value& answer) {
  std::string out = "<?xml version=\"1.0\"?>\n<methodResponse><params><param>";
  append(out, answer);
  return out + "</param></params></methodResponse>\n";
}

HttpMessage::State HttpMessage::take(std::span<const std::uint8_t> bytes) {
  if (state_ != State::unfinished) return state_;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (in_body_) {
    body_ += text.substr(0, longest_body + 1 - std::min(body_.size(), longest_body));
    return end();
  }
  constexpr std::string_view mark = "\r\n\r\n";
  const std::size_t before = header_.size();
  header_ += text.substr(0, longest_header + mark.size());
  const auto at = header_.find(mark, before < mark.size() ? 0 : before - mark.size() + 1);
  if (at == std::string::npos) {
    if (header_.size() > longest_header) state_ = State::broken;
    return state_;
  }
  if (at > longest_header || !read_header(std::string_view(header_).substr(0, at)))
    return state_ = State::broken;
  in_body_ = true;
  body_ = text.substr(at + mark.size() - before).substr(0, longest_body + 1);
  return end();
}

/// The first line, and what says how long the body is.
bool HttpMessage::read_header(std::string_view header) {
  const auto is = [](std::string_view name, std::string_view known) {
    return std::equal(name.begin(), name.end(), known.begin(), known.end(), [](char a, char b) {
      return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
    });
  };
  for (bool first = true; !header.empty(); first = false) {
    const auto end = std::min(header.find("\r\n"), header.size());
    std::string_view line = header.substr(0, end);
    header.remove_prefix(std::min(end + 2, header.size()));
    if (first) {
      const bool post = line.starts_with("POST ") && line.find(" HTTP/1.") != std::string_view::npos;
      const bool fine = line.starts_with("HTTP/1.") &&
                        line.substr(std::min<std::size_t>(8, line.size())).starts_with(" 200");
      if (!(kind_ == Kind::request ? post : fine)) return false;
      continue;
    }
    const auto colon = line.find(':');
    if (colon == std::string_view::npos) return false;
    const std::string_view name = line.substr(0, colon);
    if (is(name, "transfer-encoding")) return false;
    if (!is(name, "content-length")) continue;
    std::int64_t n = -1;
    if (!number(line.substr(colon + 1), n) || n < 0 || n > static_cast<std::int64_t>(longest_body) ||
        (length_ && *length_ != static_cast<std::size_t>(n)))
      return false;
    length_ = static_cast<std::size_t>(n);
  }
  return length_ || kind_ == Kind::answer;
}

HttpMessage::State HttpMessage::end() {
  if (length_ && body_.size() >= *length_) {
    body_.resize(*length_);
    state_ = State::whole;
  } else if (body_.size() > longest_body) {
    state_ = State::broken;
  }
  return state_;
}

HttpMessage::State HttpMessage::closed() {
  if (state_ == State::unfinished) state_ = in_body_ && !length_ ? State::whole : State::broken;
  return state_;
}

std::string http_request(const std::string& host, const std::string& path, const std::string& body) {
  return "POST " + path + " HTTP/1.1\r\nHost: " + host +
         "\r\nUser-Agent: skinctl\r\nContent-Type: text/xml\r\nConnection: close\r\nContent-Length: " +
         std::to_string(body.size()) + "\r\n\r\n" + body;
}
std::string http_answer(const std::string& body) {
  return "HTTP/1.1 200 OK\r\nServer: skinctl\r\nContent-Type: text/xml\r\nConnection: "
         "close\r\nContent-Length: " +
         std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::optional<Uri> parse_uri(std::string_view text) {
  constexpr std::string_view scheme = "http://";
  if (!text.starts_with(scheme) || text.size() > 512) return std::nullopt;
  text.remove_prefix(scheme.size());
  const auto slash = std::min(text.find('/'), text.size());
  const std::string_view place = text.substr(0, slash), path = text.substr(slash);
  const auto colon = place.rfind(':');
  if (colon == std::string_view::npos || colon == 0 || colon > 255) return std::nullopt;
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '.' || c == '_';
  };
  Uri uri;
  uri.host = place.substr(0, colon);
  if (!std::all_of(uri.host.begin(), uri.host.end(), plain)) return std::nullopt;
  const std::string_view digits = place.substr(colon + 1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), uri.port);
  if (error != std::errc() || end != digits.data() + digits.size() || uri.port == 0) return std::nullopt;
  uri.path = path.empty() ? "/" : std::string(path);
  if (!std::all_of(uri.path.begin(), uri.path.end(), [&](char c) { return plain(c) || c == '/'; }))
    return std::nullopt;
  return uri;
}

}  // namespace adapters::ros1
