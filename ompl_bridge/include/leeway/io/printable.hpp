// SPDX-License-Identifier: BSD-3-Clause
// Text that files gave, for a message: names of links, columns and keys may have any bytes.
#pragma once

#include <string>

namespace leeway::io
{

/// The text on one line and in UTF-8: line breaks and tabs become blanks, other bytes that cannot be printed (a byte 0, the sequences that
/// command a terminal) hexadecimal numbers.
std::string printable( const std::string& text );

} // namespace leeway::io
