// SPDX-License-Identifier: BSD-3-Clause
// The nodes of a search tree in flat arrays, and the nearest of them by a scan of floats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace leeway::planners
{

class Space;

constexpr std::uint32_t no_node = 0xffffffffu;

/// Nodes are numbered from 0 in the order of add(). States are kept twice: in doubles, exact, for edges; in floats for the scan,
/// in blocks of `lanes` nodes, one variable after another within a block, so that the compiler vectorises over nodes.
class Tree
{
public:
	static constexpr std::size_t lanes = 16;

	explicit Tree( const Space& space );
	void clear();
	/// The edge from the parent is not proved; a root has none.
	/// @param q [size of the space], normalised @param parent no_node for a root
	std::uint32_t add( const double* q, std::uint32_t parent );
	/// Removes a node and all nodes below it. The others keep their order; their numbers change.
	void cut( std::uint32_t node );
	std::size_t size() const { return m_parent.size(); }
	const double* state( std::uint32_t node ) const { return m_states.data() + node * m_dimension; }
	std::uint32_t parent( std::uint32_t node ) const { return m_parent[node]; }
	/// True if all edges from the root to the node are proved.
	bool isProved( std::uint32_t node ) const { return m_proved[node] != 0; }
	/// The edge from the parent is proved, and so is the parent.
	void setProved( std::uint32_t node ) { m_proved[node] = 1; }
	/// The nearest node, the lowest number of equal ones; the tree must not be empty. Distances are of floats: a node may be
	/// chosen that is farther than another by a rounding.
	/// @param q [size of the space], normalised
	std::uint32_t nearest( const double* q ) const;

private:
	void copyToBlocks( std::size_t node );

	std::size_t m_dimension;
	std::vector<unsigned char> m_wraps;
	std::vector<double> m_states;
	std::vector<float> m_blocks;
	std::vector<std::uint32_t> m_parent;
	std::vector<unsigned char> m_proved;
	std::vector<std::uint32_t> m_number; ///< scratch of cut()
	mutable std::vector<float> m_target;
};

} // namespace leeway::planners
