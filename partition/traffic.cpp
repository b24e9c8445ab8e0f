#include "partition/traffic.hpp"

#include <time.h>

#include <set>
#include <unordered_map>

namespace taut {

namespace {

struct Persistent { ///< a message that is sent again and again
  int rank;
  Global bytes;
};

struct Tally : PhaseTraffic {
  std::set<int> met;
};

struct Counting {
  bool on = false;
  bool in_halo = false;
  int ranks = 1;
  Phase phase = Phase::setup;
  double clock = 0, cpu = 0; ///< when the phase was entered or last looked at
  std::array<Tally, phase_names.size()> tallies;
  std::unordered_map<MPI_Request, Persistent> persistent;

  Tally& here() { return tallies[std::size_t(phase)]; }
};

Counting counting;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Sets down the time since the last call.
void settle() {
  const double clock = PMPI_Wtime(), cpu = cpu_seconds();
  counting.here().seconds += clock - counting.clock;
  counting.here().work += cpu - counting.cpu;
  counting.clock = clock;
  counting.cpu = cpu;
}

void count_message(int rank, Global bytes) {
  Tally& tally = counting.here();
  ++tally.messages;
  tally.bytes += bytes;
  if (rank >= 0) tally.met.insert(rank);
  if (!counting.in_halo) return;
  ++tally.halo_messages;
  tally.halo_bytes += bytes;
}

/// Time inside of MPI is no work; what is not counted costs one look.
class Call {
public:
  Call() : began_(counting.on ? cpu_seconds() : 0) {}
  ~Call() {
    if (counting.on) counting.here().work -= cpu_seconds() - began_;
  }
  Call(const Call&) = delete;

private:
  double began_;
};

constexpr int itself = -2, unknown = -1;

/// The rank among all; `unknown` on a communicator of fewer.
int rank_among_all(MPI_Comm comm, int rank) {
  int mine = 0, size = 0;
  PMPI_Comm_rank(comm, &mine);
  if (mine == rank || rank == MPI_PROC_NULL) return itself;
  PMPI_Comm_size(comm, &size);
  return size == counting.ranks ? rank : unknown;
}

Global bytes_of(int count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return Global(count) * size;
}

void sent(int count, MPI_Datatype type, int to, MPI_Comm comm) {
  if (!counting.on) return;
  if (const int rank = rank_among_all(comm, to); rank != itself) count_message(rank, bytes_of(count, type));
}

void prepared(int count, MPI_Datatype type, int to, MPI_Comm comm, MPI_Request request) {
  if (!counting.on) return;
  counting.persistent[request] = {rank_among_all(comm, to), bytes_of(count, type)};
}

void started(MPI_Request request) {
  if (!counting.on) return;
  const auto found = counting.persistent.find(request);
  if (found == counting.persistent.end() || found->second.rank == itself) return;
  count_message(found->second.rank, found->second.bytes);
}

bool has_others(MPI_Comm comm) {
  int size = 1;
  PMPI_Comm_size(comm, &size);
  return size > 1;
}

void reduced(MPI_Comm comm) {
  if (counting.on) counting.here().reductions += has_others(comm);
}
void met(MPI_Comm comm) {
  if (counting.on) counting.here().collectives += has_others(comm);
}

} // namespace

void count_traffic() {
  counting.on = true;
  counting.ranks = size_of(MPI_COMM_WORLD);
  counting.clock = PMPI_Wtime();
  counting.cpu = cpu_seconds();
}

std::array<PhaseTraffic, phase_names.size()> traffic() {
  if (counting.on) settle();
  std::array<PhaseTraffic, phase_names.size()> result;
  for (std::size_t k = 0; k < result.size(); ++k) {
    result[k] = counting.tallies[k];
    result[k].neighbours = Global(counting.tallies[k].met.size());
  }
  return result;
}

PhaseScope::PhaseScope(Phase phase) : before_(counting.phase) {
  if (counting.on) settle();
  counting.phase = phase;
  ++counting.here().entered;
}

PhaseScope::~PhaseScope() {
  if (counting.on) settle();
  counting.phase = before_;
}

HaloScope::HaloScope() {
  counting.in_halo = true;
  if (counting.on) ++counting.here().halo_updates;
}

HaloScope::~HaloScope() { counting.in_halo = false; }

} // namespace taut

// MPI's own functions under their second names, with a count in front. PETSc's calls arrive here too, as the
// linker prefers what the program defines.
using namespace taut;

int MPI_Isend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request* request) {
  const Call call;
  sent(count, type, to, comm);
  return PMPI_Isend(data, count, type, to, tag, comm, request);
}

int MPI_Send(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  const Call call;
  sent(count, type, to, comm);
  return PMPI_Send(data, count, type, to, tag, comm);
}

int MPI_Sendrecv(const void* data, int count, MPI_Datatype type, int to, int tag, void* in, int in_count,
                 MPI_Datatype in_type, int from, int in_tag, MPI_Comm comm, MPI_Status* status) {
  const Call call;
  sent(count, type, to, comm);
  return PMPI_Sendrecv(data, count, type, to, tag, in, in_count, in_type, from, in_tag, comm, status);
}

int MPI_Send_init(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
                  MPI_Request* request) {
  const int status = PMPI_Send_init(data, count, type, to, tag, comm, request);
  prepared(count, type, to, comm, *request);
  return status;
}

int MPI_Start(MPI_Request* request) {
  const Call call;
  started(*request);
  return PMPI_Start(request);
}

int MPI_Startall(int count, MPI_Request requests[]) {
  const Call call;
  for (int k = 0; k < count; ++k) started(requests[k]);
  return PMPI_Startall(count, requests);
}

int MPI_Request_free(MPI_Request* request) {
  counting.persistent.erase(*request);
  return PMPI_Request_free(request);
}

int MPI_Wait(MPI_Request* request, MPI_Status* status) {
  const Call call;
  return PMPI_Wait(request, status);
}

int MPI_Waitall(int count, MPI_Request requests[], MPI_Status statuses[]) {
  const Call call;
  return PMPI_Waitall(count, requests, statuses);
}

int MPI_Waitany(int count, MPI_Request requests[], int* index, MPI_Status* status) {
  const Call call;
  return PMPI_Waitany(count, requests, index, status);
}

int MPI_Recv(void* data, int count, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status* status) {
  const Call call;
  return PMPI_Recv(data, count, type, from, tag, comm, status);
}

int MPI_Allreduce(const void* in, void* out, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const Call call;
  reduced(comm);
  return PMPI_Allreduce(in, out, count, type, op, comm);
}

int MPI_Iallreduce(const void* in, void* out, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm,
                   MPI_Request* request) {
  const Call call;
  reduced(comm);
  return PMPI_Iallreduce(in, out, count, type, op, comm, request);
}

int MPI_Reduce(const void* in, void* out, int count, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm) {
  const Call call;
  reduced(comm);
  return PMPI_Reduce(in, out, count, type, op, root, comm);
}

int MPI_Exscan(const void* in, void* out, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const Call call;
  reduced(comm);
  return PMPI_Exscan(in, out, count, type, op, comm);
}

int MPI_Scan(const void* in, void* out, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const Call call;
  reduced(comm);
  return PMPI_Scan(in, out, count, type, op, comm);
}

int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  const Call call;
  met(comm);
  return PMPI_Bcast(data, count, type, root, comm);
}

int MPI_Barrier(MPI_Comm comm) {
  const Call call;
  met(comm);
  return PMPI_Barrier(comm);
}

int MPI_Allgather(const void* out, int count, MPI_Datatype type, void* in, int in_count, MPI_Datatype in_type,
                  MPI_Comm comm) {
  const Call call;
  met(comm);
  return PMPI_Allgather(out, count, type, in, in_count, in_type, comm);
}

int MPI_Alltoall(const void* out, int count, MPI_Datatype type, void* in, int in_count, MPI_Datatype in_type,
                 MPI_Comm comm) {
  const Call call;
  met(comm);
  return PMPI_Alltoall(out, count, type, in, in_count, in_type, comm);
}
