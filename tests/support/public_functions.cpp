// not sanitized: for tests that read the tree
#include "tests/support/public_functions.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <set>
#include <sstream>

namespace skinctl::testing {
namespace {

namespace fs = std::filesystem;

struct Token {
  std::string text;
  int line = 0;
};
using Tokens = std::vector<Token>;

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool is_name(const std::string& s) {
  return is_word(s[0]) && std::isdigit(static_cast<unsigned char>(s[0])) == 0;
}

/// Words and signs, without comments, the lines of the preprocessor and what stands in quotes.
Tokens tokens_of(const std::string& text) {
  Tokens out;
  int line = 1;
  bool fresh = true;  // nothing but blanks on this line as yet
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    const auto skip_to = [&](std::size_t end) {
      for (end = std::min(end, text.size()); i < end; ++i) line += text[i] == '\n';
    };
    if (c == '\n') {
      ++line, ++i, fresh = true;
    } else if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      ++i;
    } else if (c == '#' && fresh) {
      std::size_t end = text.find('\n', i);
      while (end != std::string::npos && text[end - 1] == '\\') end = text.find('\n', end + 1);
      skip_to(end);
    } else if (text.compare(i, 2, "//") == 0) {
      skip_to(text.find('\n', i));
    } else if (text.compare(i, 2, "/*") == 0) {
      skip_to(text.find("*/", i) + 2);
    } else if (text.compare(i, 3, "R\"(") == 0) {
      out.push_back({"\"", line}), skip_to(text.find(")\"", i) + 2), fresh = false;
    } else if (c == '"' || c == '\'') {
      std::size_t end = i + 1;
      while (end < text.size() && text[end] != c) end += text[end] == '\\' ? 2U : 1U;
      out.push_back({"\"", line}), skip_to(end + 1), fresh = false;
    } else {
      std::size_t end = i + 1;
      if (is_word(c))
        while (end < text.size() && (is_word(text[end]) ||
                                     (text[end] == '\'' && std::isdigit(static_cast<unsigned char>(c)) != 0)))
          ++end;
      else if (text.compare(i, 2, "::") == 0 || text.compare(i, 2, "->") == 0 ||
               text.compare(i, 2, "&&") == 0 || text.compare(i, 2, "==") == 0 ||
               text.compare(i, 2, "<=") == 0 || text.compare(i, 2, ">=") == 0 ||
               text.compare(i, 2, "!=") == 0)
        end = i + 2;
      out.push_back({text.substr(i, end - i), line});
      i = end, fresh = false;
    }
  }
  return out;
}

/// Behind the bracket that closes the one at `at`.
std::size_t behind(const Tokens& t, std::size_t at, const char* open, const char* close) {
  int depth = 0;
  for (; at < t.size(); ++at) {
    if (t[at].text == open) ++depth;
    if (t[at].text == close && --depth == 0) return at + 1;
  }
  return at;
}
/// Behind the angle that closes the one at `at`; comparisons stand in parentheses there.
std::size_t behind_angle(const Tokens& t, std::size_t at) {
  int depth = 0;
  while (at < t.size()) {
    if (t[at].text == "(") {
      at = behind(t, at, "(", ")");
      continue;
    }
    if (t[at].text == "<") ++depth;
    if (t[at].text == ">" && --depth == 0) return at + 1;
    ++at;
  }
  return at;
}

/// A declaration's words without `template <...>`, attributes and the requires clause before its name.
Tokens declaration(const Tokens& t) {
  Tokens out;
  for (std::size_t i = 0; i < t.size();) {
    if (t[i].text == "template" && i + 1 < t.size() && t[i + 1].text == "<") {
      i = behind_angle(t, i + 1);
    } else if (t[i].text == "[" && i + 1 < t.size() && t[i + 1].text == "[") {
      i = behind(t, i, "[", "]");
    } else if (t[i].text == "requires" &&
               std::none_of(out.begin(), out.end(), [](const Token& x) { return x.text == "("; })) {
      // Of the clause: a primary expression after another, joined by && and ||.
      ++i;
      while (i < t.size()) {
        while (i < t.size() && t[i].text == "!") ++i;
        if (i < t.size() && t[i].text == "requires") {
          ++i;
          if (t[i].text == "(") i = behind(t, i, "(", ")");
          i = behind(t, i, "{", "}");
        } else if (i < t.size() && t[i].text == "(") {
          i = behind(t, i, "(", ")");
        } else {
          while (i < t.size()) {
            ++i;
            if (i < t.size() && t[i].text == "<") i = behind_angle(t, i);
            if (i < t.size() && t[i].text == "::") {
              ++i;
              continue;
            }
            break;
          }
        }
        if (i < t.size() && (t[i].text == "&&" || t[i].text == "|")) {
          i += t[i].text == "|" ? 2U : 1U;
          continue;
        }
        break;
      }
    } else {
      out.push_back(t[i++]);
    }
  }
  return out;
}

struct Scope {
  enum Kind { space, type } kind;
  std::string name;
  bool open;            ///< what stands here may be called
  bool closed = false;  ///< and nothing ever may
};

const std::set<std::string> no_names = {"explicit", "noexcept",      "decltype", "alignas",       "requires",
                                        "if",       "static_assert", "sizeof",   "__attribute__", "_Pragma",
                                        "asm"};

/// The function that a declaration declares, if it does.
bool function_of(const Tokens& all, const std::string& type, PublicFunction& f) {
  const Tokens t = declaration(all);
  if (t.empty() || t[0].text == "using" || t[0].text == "typedef" || t[0].text == "friend" ||
      t[0].text == "concept" || t[0].text == "static_assert" || t[0].text == "extern")
    return false;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i].text == "operator" || t[i].text == "~" || t[i].text == "=") return false;
    if (t[i].text == "<") {
      i = behind_angle(t, i) - 1;
      continue;
    }
    if (t[i].text != "(") continue;
    const std::size_t end = behind(t, i, "(", ")");
    if (i == 0 || !is_name(t[i - 1].text)) return false;
    if (no_names.count(t[i - 1].text) != 0) {
      i = end - 1;
      continue;
    }
    f.name = t[i - 1].text;
    if (i >= 2 && t[i - 2].text == "::") return false;  // a member, defined outside of its class
    f.line = t[i - 1].line;
    f.throws = true;
    for (std::size_t k = i + 1; k + 1 < end; ++k)
      f.parameters += (f.parameters.empty() ? "" : " ") + t[k].text;
    for (std::size_t k = end; k < t.size(); ++k) {
      if (t[k].text == "noexcept") f.throws = false;
      if (t[k].text == "delete" || t[k].text == "default") return false;
      if (t[k].text == "->" && type.empty() && std::isupper(static_cast<unsigned char>(f.name[0])) != 0)
        return false;
    }
    if (type.empty() && std::isupper(static_cast<unsigned char>(f.name[0])) != 0) return false;  // a macro
    return true;
  }
  return false;
}

}  // namespace

std::vector<PublicFunction> public_functions(const std::string& header, const std::string& text) {
  const Tokens t = tokens_of(text);
  std::vector<PublicFunction> out;
  std::vector<Scope> scopes{{Scope::space, "", true, false}};
  Tokens head;
  const auto declared = [&] {
    PublicFunction f;
    if (scopes.back().open &&
        function_of(head, scopes.back().kind == Scope::type ? scopes.back().name : "", f)) {
      f.header = header;
      if (scopes.back().kind == Scope::type)
        for (const Scope& s : scopes)
          if (s.kind == Scope::type) f.of += (f.of.empty() ? "" : "::") + s.name;
      out.push_back(f);
    }
  };
  for (std::size_t i = 0; i < t.size(); ++i) {
    const std::string& word = t[i].text;
    if (word == "(") {
      const std::size_t end = behind(t, i, "(", ")");
      head.insert(head.end(), t.begin() + static_cast<std::ptrdiff_t>(i),
                  t.begin() + static_cast<std::ptrdiff_t>(end));
      i = end - 1;
    } else if (word == ";") {
      declared();
      head.clear();
    } else if (word == "}") {
      if (scopes.size() > 1) scopes.pop_back();
      head.clear();
    } else if (word == ":" && head.size() == 1 &&
               (head[0].text == "public" || head[0].text == "private" || head[0].text == "protected")) {
      scopes.back().open = head[0].text == "public" && !scopes.back().closed;
      head.clear();
    } else if (word == "{") {
      Tokens d;  // without what stands in parentheses, as default arguments
      const Tokens whole = declaration(head);
      for (std::size_t k = 0; k < whole.size(); ++k) {
        d.push_back(whole[k]);
        if (whole[k].text == "(") k = behind(whole, k, "(", ")") - 1;
      }
      const auto has = [&](const char* w) {
        return std::find_if(d.begin(), d.end(), [&](const Token& x) { return x.text == w; });
      };
      const bool parentheses = has("(") != d.end() && has("alignas") == d.end();
      if (const auto space = has("namespace"); space != d.end()) {
        const bool named = space + 1 != d.end();
        const std::string name = named ? d.back().text : "";
        scopes.push_back({Scope::space, name, scopes.back().open && named && name != "detail", false});
        head.clear();
      } else if (!parentheses && has("=") == d.end() && has("enum") == d.end() &&
                 (has("struct") != d.end() || has("class") != d.end())) {
        const bool is_class = has("class") != d.end();
        auto name = is_class ? has("class") : has("struct");
        do ++name;
        while (name + 1 < d.end() && (name->text == "alignas" || name->text == "SKINCTL_EMPTY"));
        // A class in which nothing may be called stays closed, whatever it calls public.
        const bool seen = scopes.back().open;
        scopes.push_back({Scope::type, name < d.end() ? name->text : "", seen && !is_class, !seen});
        head.clear();
      } else {
        // A function's body, or what a member starts as.
        const bool body = parentheses && has("=") == d.end();
        if (body) declared();
        const bool initialised = !head.empty() && !body;
        // `: member_{x}` of a constructor goes on to its body.
        const std::size_t end = behind(t, i, "{", "}");
        i = end - 1;
        if (body && i + 1 < t.size() && (t[i + 1].text == "," || t[i + 1].text == "{")) {
          while (i + 1 < t.size() && t[i + 1].text != "{") {
            ++i;
            if (t[i].text == "(") i = behind(t, i, "(", ")") - 1;
            if (is_name(t[i].text) && i + 1 < t.size() && t[i + 1].text == "{")
              i = behind(t, i + 1, "{", "}") - 1;
          }
          if (i + 1 < t.size() && t[i + 1].text == "{") i = behind(t, i + 1, "{", "}") - 1;
        }
        if (!initialised) head.clear();
      }
    } else {
      head.push_back(t[i]);
    }
  }
  return out;
}

std::vector<PublicFunction> public_functions(const fs::path& include,
                                             const std::vector<std::string>& without) {
  std::vector<PublicFunction> out;
  std::vector<fs::path> headers;
  for (const auto& entry : fs::recursive_directory_iterator(include))
    if (entry.path().extension() == ".hpp") headers.push_back(entry.path());
  std::sort(headers.begin(), headers.end());
  for (const auto& path : headers) {
    const std::string name = fs::relative(path, include).generic_string();
    if (name.find("/detail/") != std::string::npos) continue;
    if (std::any_of(without.begin(), without.end(),
                    [&](const std::string& folder) { return name.rfind("skinctl/" + folder + "/", 0) == 0; }))
      continue;
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    for (auto& f : public_functions(name, text.str())) out.push_back(std::move(f));
  }
  return out;
}

}  // namespace skinctl::testing
