// SPDX-License-Identifier: BSD-3-Clause
// A folder for the files that a benchmark generates; the destructor removes it with everything in it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <unistd.h>

class TemporaryFolder
{
public:
	/// @throws std::runtime_error with the path if it cannot be made
	TemporaryFolder()
	{
		std::string name = ( std::filesystem::temp_directory_path() / "leeway-bench-XXXXXX" ).string();
		if ( mkdtemp( name.data() ) == nullptr )
		{
			throw std::runtime_error( name + ": no temporary folder can be made there" );
		}
		m_path = name;
	}
	TemporaryFolder( const TemporaryFolder& ) = delete;
	TemporaryFolder& operator=( const TemporaryFolder& ) = delete;
	~TemporaryFolder()
	{
		std::error_code ignored;
		std::filesystem::remove_all( m_path, ignored );
	}
	const std::filesystem::path& path() const { return m_path; }

private:
	std::filesystem::path m_path;
};
