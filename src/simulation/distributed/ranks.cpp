#include "simulation/distributed/ranks.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <thread>

#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {
namespace {

/// MPI's counts are int.
constexpr std::size_t most_bytes = std::size_t{1} << 30U;
constexpr int tag = 31;

int piece_of(std::size_t size, std::size_t begin) {
    return static_cast<int>(std::min(most_bytes, size - begin));
}

/// MPI waits busily and uses a whole core. Short waits do not sleep.
void wait_asleep(MPI_Request& request) {
    constexpr int looks_awake = 2000;
    for (int done = 0, looks = 0; done == 0; ++looks) {
        must(MPI_Test(&request, &done, MPI_STATUS_IGNORE));
        if (done != 0) return;
        if (looks < looks_awake)
            std::this_thread::yield();
        else
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

}  // namespace

Ranks::Ranks(MPI_Comm comm) : comm_(comm) {
    must(MPI_Comm_rank(comm, &own_));
    must(MPI_Comm_size(comm, &count_));
}

void Ranks::add_up(std::span<double> numbers) const {
    must(MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, MPI_SUM, comm_));
}

double Ranks::sum(double own) const {
    add_up({&own, 1});
    return own;
}

double Ranks::smallest(double own) const {
    must(MPI_Allreduce(MPI_IN_PLACE, &own, 1, MPI_DOUBLE, MPI_MIN, comm_));
    return own;
}

double Ranks::largest(double own) const {
    return -smallest(-own);
}

int Ranks::largest(int own) const {
    must(MPI_Allreduce(MPI_IN_PLACE, &own, 1, MPI_INT, MPI_MAX, comm_));
    return own;
}

Status Ranks::agree(const Status& own) const {
    const int mine = own ? count_ : own_;
    int first = count_;
    MPI_Request request{};
    must(MPI_Iallreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm_, &request));
    wait_asleep(request);
    if (first == count_) return {};
    int cause = own ? 0 : static_cast<int>(own.error().cause);
    std::string message = own ? "" : own.error().message;
    std::uint64_t size = message.size();
    must(MPI_Bcast(&cause, 1, MPI_INT, first, comm_));
    must(MPI_Bcast(&size, 1, MPI_UINT64_T, first, comm_));
    message.resize(size);
    must(MPI_Bcast(message.data(), static_cast<int>(size), MPI_CHAR, first, comm_));
    return tl::unexpected(Error{static_cast<Cause>(cause), std::move(message)});
}

void Ranks::broadcast(std::string& bytes) const {
    std::uint64_t size = bytes.size();
    must(MPI_Bcast(&size, 1, MPI_UINT64_T, 0, comm_));
    bytes.resize(size);
    for (std::size_t begin = 0; begin < size; begin += most_bytes)
        must(MPI_Bcast(bytes.data() + begin, piece_of(size, begin), MPI_CHAR, 0, comm_));
}

void Ranks::send(const std::string& bytes, int to) const {
    const std::uint64_t size = bytes.size();
    must(MPI_Send(&size, 1, MPI_UINT64_T, to, tag, comm_));
    for (std::size_t begin = 0; begin < size; begin += most_bytes)
        must(MPI_Send(bytes.data() + begin, piece_of(size, begin), MPI_CHAR, to, tag, comm_));
}

std::string Ranks::receive() const {
    std::uint64_t size = 0;
    MPI_Request request{};
    must(MPI_Irecv(&size, 1, MPI_UINT64_T, 0, tag, comm_, &request));
    wait_asleep(request);
    std::string bytes(size, '\0');
    for (std::size_t begin = 0; begin < size; begin += most_bytes)
        must(MPI_Recv(bytes.data() + begin, piece_of(size, begin), MPI_CHAR, 0, tag, comm_, MPI_STATUS_IGNORE));
    return bytes;
}

}  // namespace pliant::sim::distributed
