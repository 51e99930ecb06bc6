// SPDX-License-Identifier: BSD-3-Clause
// PNG pictures as height maps: the values as they are in the file, no gamma.
//
// libpng reports errors by longjmp. The function that it may jump back to holds nothing with a destructor.
#include "cloud/height_map.hpp"

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

/// Keeps a row's buffer in bounds; Limits::points bounds the whole.
constexpr png_uint_32 max_side = 32768;

struct PngFile
{
	PngFile() = default;
	PngFile( const PngFile& ) = delete;
	PngFile& operator=( const PngFile& ) = delete;
	~PngFile() { png_destroy_read_struct( &png, &info, nullptr ); }

	png_structp png = nullptr;
	png_infop info = nullptr;
	const unsigned char* bytes = nullptr;
	std::size_t size = 0, at = 0;
	char message[160] = "";
	png_uint_32 width = 0, height = 0;
	bool any_picture = false;
	int depth = 0, stride = 0;             ///< bits of a sample; bytes of a pixel
	std::vector<double>* values = nullptr; ///< rows as they come, the highest y first
	std::vector<unsigned char>* row = nullptr;
};

void readBytes( png_structp png, png_bytep out, png_size_t count )
{
	PngFile& file = *static_cast<PngFile*>( png_get_io_ptr( png ) );
	if ( count > file.size - file.at )
	{
		png_error( png, "the file ends too early" );
	}
	std::memcpy( out, file.bytes + file.at, count );
	file.at += count;
}

[[noreturn]] void onError( png_structp png, png_const_charp text )
{
	PngFile& file = *static_cast<PngFile*>( png_get_error_ptr( png ) );
	std::size_t length = std::min( std::strlen( text ), sizeof file.message - 1 );
	std::memcpy( file.message, text, length );
	file.message[length] = '\0';
	png_longjmp( png, 1 );
}

void onWarning( png_structp, png_const_charp )
{
	// of chunks that do not matter here
}

void readHeader( png_structp png, png_infop info, PngFile& file )
{
	png_read_info( png, info );
	file.width = png_get_image_width( png, info );
	file.height = png_get_image_height( png, info );
	file.depth = png_get_bit_depth( png, info );
	if ( file.any_picture )
	{
		png_set_expand( png );
		png_set_strip_16( png );
	}
	else if ( png_get_color_type( png, info ) != PNG_COLOR_TYPE_GRAY || ( file.depth != 8 && file.depth != 16 ) )
	{
		png_error( png, "it is not grey of 8 or 16 bits" );
	}
	else if ( png_get_valid( png, info, PNG_INFO_tRNS ) != 0 )
	{
		png_error( png, "it has transparent parts" );
	}
	if ( std::uint64_t( file.width ) * file.height > currentLimits().points )
	{
		png_error( png, "it has more heights than the limit points (--input-limit points=N, or leeway::io::Limits) allows" );
	}
	// Its passes need the whole picture in memory on the word of the header
	if ( png_get_interlace_type( png, info ) != PNG_INTERLACE_NONE )
	{
		png_error( png, "it is interlaced" );
	}
	png_read_update_info( png, info );
	file.depth = png_get_bit_depth( png, info );
	file.stride = png_get_channels( png, info ) * file.depth / 8;
}

/// @return false with a message in `file`
bool readPng( PngFile& file )
{
	file.png = png_create_read_struct( PNG_LIBPNG_VER_STRING, &file, onError, onWarning );
	file.info = file.png != nullptr ? png_create_info_struct( file.png ) : nullptr;
	if ( file.info == nullptr )
	{
		std::strcpy( file.message, "there is no memory for it" );
		return false;
	}
	if ( setjmp( png_jmpbuf( file.png ) ) != 0 )
	{
		return false;
	}
	png_set_user_limits( file.png, max_side, max_side );
	png_set_read_fn( file.png, &file, readBytes );
	readHeader( file.png, file.info, file );
	// One row at a time: memory grows with the rows that the file really holds
	file.row->resize( png_get_rowbytes( file.png, file.info ) );
	for ( png_uint_32 y = 0; y < file.height; ++y )
	{
		png_read_row( file.png, file.row->data(), nullptr );
		for ( png_uint_32 x = 0; x < file.width; ++x )
		{
			const unsigned char* p = file.row->data() + x * static_cast<unsigned>( file.stride );
			file.values->push_back( file.depth == 8 ? p[0] : p[0] * 256 + p[1] );
		}
	}
	png_read_end( file.png, nullptr );
	return true;
}

} // namespace

HeightGrid readHeightPng( const std::string& path, bool any_picture )
{
	const std::string text = readFile( path );
	HeightGrid grid;
	std::vector<unsigned char> row;
	PngFile file;
	file.bytes = reinterpret_cast<const unsigned char*>( text.data() );
	file.size = text.size();
	file.any_picture = any_picture;
	file.values = &grid.values;
	file.row = &row;
	if ( !readPng( file ) )
	{
		throw Error( path, "", fmt::format( "is no height map: {}", file.message ),
		    any_picture ? "give a PNG that is not interlaced, or write it again"
		                : "give a PNG in grey of 8 or 16 bits, neither interlaced nor transparent, or write it again" );
	}
	grid.columns = file.width;
	grid.rows = file.height;
	// The first row of a picture is its top, where y is largest
	for ( std::size_t y = 0; y < grid.rows / 2; ++y )
	{
		auto upper = grid.values.begin() + static_cast<std::ptrdiff_t>( y * grid.columns );
		auto lower = grid.values.begin() + static_cast<std::ptrdiff_t>( ( grid.rows - 1 - y ) * grid.columns );
		std::swap_ranges( upper, upper + static_cast<std::ptrdiff_t>( grid.columns ), lower );
	}
	return grid;
}

} // namespace leeway::io::detail
