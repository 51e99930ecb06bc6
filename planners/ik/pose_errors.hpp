// SPDX-License-Identifier: BSD-3-Clause
// The error of one frame's pose in another frame, of which either may move.
#pragma once

#include "ik/descent.hpp"

#include <optional>

namespace leeway::ik
{

class PoseErrors : public Errors
{
public:
	static constexpr std::size_t rows = 6; ///< position; rotation vector times radian_length; both in the planning frame

	/// Adds both frames to the chain, which must outlive the errors.
	/// @param free_axis unit, of the tip, about which it may turn
	PoseErrors( Chain& chain, const io::Frame& tip, const io::Frame& base, const std::optional<Vector3d>& free_axis = {} );

	/// [freedoms] that move the tip in the base.
	const std::vector<bool>& moving() const { return m_moving; }
	/// The tip shall have this pose in the base.
	void aim( const Pose& base_from_tip ) { m_wanted = base_from_tip; }
	void evaluate( const double* q, Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian ) override;
	/// The change of the residual by a motion of the wanted pose, in the base, at the state of the last evaluate().
	Eigen::VectorXd flow( const Vector3d& linear, const Vector3d& angular ) const;
	/// The tip in the base, at a state.
	Pose pose( const double* q );

private:
	Chain& m_chain;
	ChainFrame m_tip, m_base;
	std::vector<bool> m_moving;
	std::optional<Vector3d> m_free_axis;
	Pose m_wanted;
	Matrix3d m_base_turn = Matrix3d::Identity(), m_turns = Matrix3d::Identity(); ///< turns that are errors
};

/// Metres and radians of a residual.
struct PoseExcess
{
	double metres, radians;
};
PoseExcess excessOf( const Eigen::VectorXd& residual );

} // namespace leeway::ik
