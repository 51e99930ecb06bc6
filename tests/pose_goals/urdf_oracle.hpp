// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics of the tests: a URDF read with an XML parser, and products of homogeneous matrices. No code of leeway.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

/// Row-major, 4 x 4.
using Matrix = std::array<std::array<double, 4>, 4>;

Matrix identity();
Matrix product( const Matrix& a, const Matrix& b );
Matrix inverseOf( const Matrix& a ); ///< of a rigid motion
Matrix fromQuaternion( const std::array<double, 3>& position, const std::array<double, 4>& xyzw );
std::array<double, 3> transformed( const Matrix& a, const std::array<double, 3>& point );
/// a, b, c with r = Rx(a) Ry(b) Rz(c), b in [-pi/2, pi/2].
std::array<double, 3> eulerXyz( const Matrix& r );
/// The rotation vector, of at most half a turn.
std::array<double, 3> rotationVector( const Matrix& r );

class UrdfOracle
{
public:
	/// @param text of the URDF
	explicit UrdfOracle( const std::string& text );

	/// Pose of a link in the frame of the root. Joints without a value are at 0; mimic joints follow.
	Matrix pose( const std::string& link, const std::map<std::string, double>& values ) const;

	struct Joint
	{
		std::string name, type, parent, child, mimic;
		Matrix origin = identity();
		std::array<double, 3> axis = { 1, 0, 0 };
		double lower = 0, upper = 0, multiplier = 1, offset = 0;
	};
	const std::vector<Joint>& joints() const { return m_joints; }

private:
	double value( const Joint& joint, const std::map<std::string, double>& values ) const;
	std::vector<Joint> m_joints;
};
