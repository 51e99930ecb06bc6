// SPDX-License-Identifier: BSD-3-Clause
// Damped least squares within bounds: the steps of all inverse kinematics here, with an error and its Jacobian by the caller.
//
// Papers: Levenberg (1944) and Marquardt (1963) on damping; Sugihara, Solvability-unconcerned inverse kinematics by the
// Levenberg-Marquardt method (IEEE Transactions on Robotics 27, 2011), on damping by the squared error.
#pragma once

#include "ik/chain.hpp"

#include <vector>

namespace leeway::ik
{

/// Metres that count as much as a radian: about the distance of a hand from its wrist.
constexpr double radian_length = 0.2;

/// An error of a state that a descent makes 0.
class Errors
{
public:
	virtual ~Errors() = default;
	/// @param q [variables] @param residual [rows], metres @param jacobian [rows x freedoms] derivative of the residual
	virtual void evaluate( const double* q, Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian ) = 0;
};

/// [freedoms] of a chain; infinite: none. Turns of quaternions have none.
struct Bounds
{
	Eigen::VectorXd lower, upper;
};

class Descent
{
public:
	/// @param chain of the errors; it must outlive the descent @param moving [freedoms] that change them; others stay
	Descent( const Chain& chain, const std::vector<bool>& moving, std::size_t rows );

	/// Moves q into the bounds, then to a small residual within them. Does not allocate.
	/// @return true if the residual is at most 1e-11 m long
	bool run( Errors& errors, const Bounds& bounds, double* q );
	/// Evaluates the errors at q, for residual(), jacobian() and leastChange().
	void evaluate( Errors& errors, const double* q ) { errors.evaluate( q, m_residual, m_jacobian ); }
	/// The smallest change of the freedoms with `jacobian * change = wanted`, as far as the damping allows.
	const Eigen::VectorXd& leastChange( const Eigen::VectorXd& wanted, double damping );

	/// After run() and evaluate(): at the final q.
	const Eigen::VectorXd& residual() const { return m_residual; }
	const Eigen::MatrixXd& jacobian() const { return m_jacobian; }
	/// The last step, and the freedoms that stayed at their bounds during it.
	const Eigen::VectorXd& lastStep() const { return m_step; }
	const std::vector<char>& fixed() const { return m_fixed; }

private:
	void solveFor( const Eigen::VectorXd& wanted, double damping );
	void stepWithinBounds( const Bounds& bounds, const double* q, double damping );
	void move( const double* from, double* to ) const;
	void clamp( const Bounds& bounds, double* q ) const;

	const Chain& m_chain;
	std::vector<Eigen::Index> m_moving; ///< freedoms that change the errors
	Eigen::VectorXd m_residual, m_next_residual, m_weights, m_step;
	Eigen::MatrixXd m_jacobian, m_next_jacobian, m_normal;
	std::vector<double> m_try;
	std::vector<char> m_fixed; ///< [freedoms]
};

} // namespace leeway::ik
