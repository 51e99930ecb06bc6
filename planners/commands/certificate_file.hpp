// SPDX-License-Identifier: BSD-3-Clause
// --certificate: the proof of a motion as a file for independent checkers.
#pragma once

#include "leeway/certify/certificate.hpp"
#include "program/setup.hpp"

#include <optional>

namespace leeway::cli
{

/// Files whose digests a certificate keeps: robot, SRDF, scene and the motion, those that were given.
std::vector<std::string> filesOf( const CommonOptions& options, const std::string& motion );

/// The claim of a certificate.
certify::Settings claimOf( double min_d, lw_check_flags flags, std::vector<std::string> files );

class CertificateFile
{
public:
	/// Opens the file at once, if one is named. @throws io::Error
	explicit CertificateFile( const std::string& path );
	/// Makes the certificate and adds its file to those that are written together. If there is none, standard error says why.
	/// @param name of the motion, for errors
	/// @return false: it is wanted, and there is none
	bool write( const io::Problem& problem, const Input& input, const std::vector<certify::Piece>& pieces,
	    const certify::Settings& settings, const std::string& name, std::vector<OutputFile*>& files );
	/// A line about it for people; empty without one.
	const std::string& told() const { return m_told; }

private:
	std::optional<OutputFile> m_file;
	std::string m_told;
};

} // namespace leeway::cli
