// A topic of an MCAP file as a table.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <span>
#include <string>

namespace skinctl_record {

/// What `write_csv` did.
struct Table {
  std::size_t lines = 0;  ///< below the header
  std::string left_out;   ///< messages of the file that could not be read, in words; empty: none
};

/// Writes the messages of `topic` as CSV: a line for each message, of a point cloud one for each point. Times
/// are in seconds. Throws `skinctl::ConfigurationError` for a topic that is not there, whose type it does not
/// know, or with a message that is none of its type.
Table write_csv(std::span<const unsigned char> file, const std::string& topic, std::ostream& out);

}  // namespace skinctl_record
