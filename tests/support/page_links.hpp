// The links of Markdown pages to files of the repository, and those that lead nowhere.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skinctl::testing {

/// The targets of `[text](target)` and `![text](target)` in a Markdown text, outside of fenced blocks and
/// code spans, in order.
[[nodiscard]] std::vector<std::string> link_targets(const std::string& markdown);

/// The anchors of its headings, as code hosts make them: lower case, blanks as hyphens, other signs left out.
[[nodiscard]] std::vector<std::string> heading_anchors(const std::string& markdown);

/// Everything wrong with the links of the pages (`*.md`) below `top`, one sentence each: a relative link to
/// no file or folder, or to one outside of `top`, and a link to a heading that its page does not have.
/// Folders whose name begins with a dot, except for .github, and build folders are left out. Addresses of
/// other hosts are not looked at.
[[nodiscard]] std::vector<std::string> link_errors(const std::filesystem::path& top);

}  // namespace skinctl::testing
