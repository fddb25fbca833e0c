#pragma once

#include <tufa/export.h>
#include <tufa/openvdb_fwd.h>

// Names of Tufa's types, for headers that only pass them on.

namespace tufa {

class Coord;
class Error;
class Progress;
class RaySurface;
struct AdviseOptions;
struct Attribute;
struct AttributeOptions;
struct Camera;
struct Certificate;
struct CheckOptions;
struct CheckReport;
struct Chunk;
struct ChunkEntry;
struct ChunkIndex;
struct ChunkOptions;
struct CompareOptions;
struct Comparison;
struct ContourOptions;
struct ContourReport;
struct DistanceOptions;
struct DistanceReport;
struct ExtractOptions;
struct FileBytes;
struct FilterOptions;
struct FilterReport;
struct FloatMesh;
struct FloatMeshOptions;
struct GridInfo;
struct GridName;
struct LabelCount;
struct LeafCell;
struct ImageSlices;
struct Lod;
struct LodChain;
struct LodOptions;
struct LodWriteOptions;
struct LodWriteReport;
struct Mesh;
struct MethodResult;
struct NamedMesh;
struct Normal;
struct Picture;
struct PictureOptions;
struct PictureView;
struct Position;
struct ProgressState;
struct Quad;
struct RawImport;
struct Ray;
struct RayHit;
struct RaySurfaceOptions;
struct RepairOptions;
struct RepairReport;
struct SamplingReport;
struct ShapeOptions;
struct SliceOptions;
struct SurfaceComparison;
struct Triangle;
struct TruthReport;
struct UniteOptions;
struct VoxelizeOptions;
struct VoxelizeReport;
struct WriteOptions;
struct WriteReport;
enum class Ambiguity;
enum class AttributeRole;
enum class ChunkFormat;
enum class ErrorCode;
enum class GlbCompression;
enum class Inside;
enum class MeshFormat;
enum class Method;
enum class NonFinite;
enum class Normals;
enum class RawType;
enum class Shape;
enum class Smoothing;
enum class UpAxis;
enum class Winding;

namespace implicit {
class Field;
struct Box;
struct Interval;
struct Scene;
}  // namespace implicit

}  // namespace tufa
