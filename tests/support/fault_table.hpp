// The table of faults as a page shows it, and who produces the reasons.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace skinctl::testing {

/// The table of guard/faults.hpp in Markdown.
[[nodiscard]] std::string fault_table();

/// What stands between the lines `<!-- faults:begin -->` and `<!-- faults:end -->` of a page; empty without
/// them.
[[nodiscard]] std::string fault_block(const std::string& markdown);

/// The enumerators of `enum class Reason` in the text of core/status.hpp, without `count`.
[[nodiscard]] std::vector<std::string> reasons_in(const std::string& header);

/// The reasons that a source sets: named as `Reason::x` outside of comments, and not only asked for
/// (`has(Reason::x)`) or taken out of a set (`~Status(Reason::x)`, `& Status(Reason::x)`).
[[nodiscard]] std::vector<std::string> reasons_set_by(const std::string& source);

/// For each reason set below `include`, a header that does so; the table itself and testing/ do not count.
[[nodiscard]] std::map<std::string, std::string> producers(const std::filesystem::path& include);

}  // namespace skinctl::testing
