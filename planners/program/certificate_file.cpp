// SPDX-License-Identifier: BSD-3-Clause
// The certificate's file, written together with the other results.
#include "program/certificate_file.hpp"

#include <fmt/format.h>

namespace leeway::cli
{

std::vector<std::string> filesOf( const CommonOptions& options, const std::string& motion )
{
	std::vector<std::string> files;
	for ( const std::string& file : { options.robot, options.srdf, options.scene, motion } )
	{
		if ( !file.empty() )
		{
			files.push_back( file );
		}
	}
	return files;
}

CertificateFile::CertificateFile( const std::string& path )
{
	if ( !path.empty() )
	{
		m_file.emplace( "--certificate", path );
	}
}

bool CertificateFile::write( const io::Problem& problem, const Input& input, const std::vector<certify::Piece>& pieces,
    const certify::Settings& settings, const std::string& name, std::vector<OutputFile*>& files )
{
	if ( !m_file )
	{
		return true;
	}
	try
	{
		certify::Certificate certificate = certify::certify( problem, input.robot, pieces, settings, name );
		m_told = fmt::format(
		    "{}, made in {:.0f} ms\n", certify::describe( certificate, m_file->path() ), 1e3 * certificate.seconds );
		m_file->text = std::move( certificate.bytes );
	}
	catch ( const io::Error& error )
	{
		tell( "leeway: no certificate: {}\n", error.what() );
		return false;
	}
	files.push_back( &*m_file );
	return true;
}

} // namespace leeway::cli
