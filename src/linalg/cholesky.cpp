#include "linalg/cholesky.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cassert>
#include <cstring>

// Of libgomp, which CHOLMOD is linked with; declared here because other compilers ship another OpenMP and its header.
extern "C" {
int omp_get_max_active_levels(void);
void omp_set_max_active_levels(int);
}

namespace pliant::linalg {

struct Cholesky::State {
    cholmod_common common{};
    SymmetricPattern pattern;
    cholmod_factor* factor = nullptr;
    cholmod_dense* solution = nullptr;  ///< kept between solves, as are the two work spaces
    cholmod_dense* work_y = nullptr;
    cholmod_dense* work_e = nullptr;

    State() { cholmod_start(&common); }
    ~State() {
        cholmod_free_factor(&factor, &common);
        cholmod_free_dense(&solution, &common);
        cholmod_free_dense(&work_y, &common);
        cholmod_free_dense(&work_e, &common);
        cholmod_finish(&common);
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    /// A view of the pattern with these values; CHOLMOD does not write to it.
    [[nodiscard]] cholmod_sparse view(const double* values) const {
        cholmod_sparse matrix{};
        matrix.nrow = matrix.ncol = static_cast<std::size_t>(pattern.size());
        matrix.nzmax = pattern.entries();
        matrix.p = const_cast<int*>(pattern.column_start.data());
        matrix.i = const_cast<int*>(pattern.row.data());
        matrix.x = const_cast<double*>(values);
        matrix.stype = -1;
        matrix.itype = CHOLMOD_INT;
        matrix.xtype = values != nullptr ? CHOLMOD_REAL : CHOLMOD_PATTERN;
        matrix.dtype = CHOLMOD_DOUBLE;
        matrix.sorted = matrix.packed = 1;
        return matrix;
    }
};

namespace {

/// CHOLMOD's loops ask OpenMP for four threads that spin while they wait; on a shared machine that costs more than the
/// factorisation. While one of these lives, OpenMP regions run on the calling thread alone.
class OneThread {
public:
    OneThread() : before_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
    ~OneThread() { omp_set_max_active_levels(before_); }
    OneThread(const OneThread&) = delete;
    OneThread& operator=(const OneThread&) = delete;

private:
    int before_;
};

/// Fill-reducing order of the nodes: the graph is `block` times smaller than that of the unknowns.
std::vector<int> order_nodes(const SymmetricPattern& pattern, cholmod_common& common) {
    cholmod_sparse graph{};
    graph.nrow = graph.ncol = static_cast<std::size_t>(pattern.nodes);
    graph.nzmax = pattern.node_row.size();
    graph.p = const_cast<int*>(pattern.node_start.data());
    graph.i = const_cast<int*>(pattern.node_row.data());
    graph.stype = -1;
    graph.itype = CHOLMOD_INT;
    graph.xtype = CHOLMOD_PATTERN;
    graph.sorted = graph.packed = 1;
    std::vector<int> order(pattern.nodes);
    if (cholmod_metis(&graph, nullptr, 0, 1, order.data(), &common) == 0) {
        for (int i = 0; i < pattern.nodes; ++i) order[i] = i;
    }
    return order;
}

}  // namespace

Cholesky::Cholesky(const SymmetricPattern& pattern) : state_(std::make_unique<State>()) {
    const OneThread scope;
    cholmod_common& common = state_->common;
    state_->pattern = pattern;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.print = 0;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
    const std::vector<int> nodes = order_nodes(pattern, common);
    std::vector<int> unknowns;
    unknowns.reserve(pattern.size());
    for (const int node : nodes) {
        for (int u = 0; u < pattern.block; ++u) unknowns.push_back(node * pattern.block + u);
    }
    cholmod_sparse matrix = state_->view(nullptr);
    state_->factor = cholmod_analyze_p(&matrix, unknowns.data(), nullptr, 0, &common);
}

Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;
Cholesky::~Cholesky() = default;

bool Cholesky::factorise(std::span<const double> values) {
    assert(values.size() == state_->pattern.entries());
    if (state_->factor == nullptr) return false;
    const OneThread scope;
    cholmod_sparse matrix = state_->view(values.data());
    cholmod_factorize(&matrix, state_->factor, &state_->common);
    return state_->common.status == CHOLMOD_OK && state_->factor->minor == state_->factor->n;
}

void Cholesky::solve(std::span<double> right_hand_sides, int columns) const {
    const auto n = static_cast<std::size_t>(state_->pattern.size());
    assert(right_hand_sides.size() == n * static_cast<std::size_t>(columns));
    if (n == 0 || columns == 0) return;
    const OneThread scope;
    cholmod_dense b{};
    b.nrow = b.d = n;
    b.ncol = static_cast<std::size_t>(columns);
    b.nzmax = n * b.ncol;
    b.x = right_hand_sides.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, state_->factor, &b, nullptr, &state_->solution, nullptr, &state_->work_y, &state_->work_e,
                   &state_->common);
    std::memcpy(right_hand_sides.data(), state_->solution->x, sizeof(double) * b.nzmax);
}

double Cholesky::factor_entries() const {
    const cholmod_factor* factor = state_->factor;
    return factor == nullptr ? 0 : (factor->is_super != 0 ? static_cast<double>(factor->xsize) : state_->common.lnz);
}

}  // namespace pliant::linalg
