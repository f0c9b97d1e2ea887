// A topic of an MCAP file as a table.
#pragma once

#include <iosfwd>
#include <span>
#include <string>

namespace skinctl_record {

/// Writes the messages of `topic` as CSV: a line for each message, of a point cloud one for each point. Times are in
/// seconds. Returns the number of lines below the header. Throws `skinctl::ConfigurationError` for a topic that is not
/// there, whose type it does not know, or with a message that is none of its type.
std::size_t write_csv(std::span<const unsigned char> file, const std::string& topic, std::ostream& out);

}  // namespace skinctl_record
