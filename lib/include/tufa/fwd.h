#pragma once

#include <tufa/export.h>
#include <tufa/openvdb_fwd.h>

// Names of Tufa's types, for headers that only pass them on.

namespace tufa {

class ChunkFolder;
class Coord;
class Error;
class GridFile;
class Progress;
class RaySurface;
class StagedFolder;
struct AdviseOptions;
struct Attribute;
struct AttributeOptions;
struct Blob;
struct BlobFit;
struct Camera;
struct Certificate;
struct CheckComponent;
struct CheckOptions;
struct CheckReport;
struct Chunk;
struct ChunkEntry;
struct ChunkFile;
struct ChunkIndex;
struct ChunkLevel;
struct ChunkLevelEntry;
struct ChunkOptions;
struct ChunkSeam;
struct ClipBox;
struct ClipGrid;
struct Close;
struct CompareOptions;
struct Comparison;
struct ContourOptions;
struct ContourReport;
struct DistanceOptions;
struct DistanceReport;
struct DistanceSummary;
struct DroppedComponent;
struct ExtractOptions;
struct FileBytes;
struct FilterOptions;
struct FilterReport;
struct FitOptions;
struct FitStep;
struct FloatMesh;
struct FloatMeshOptions;
struct GridInfo;
struct GridName;
struct ImageSlices;
struct InterfaceReport;
struct KeepLargest;
struct LabelCount;
struct LeafCell;
struct Lod;
struct LodChain;
struct LodOptions;
struct LodWriteOptions;
struct LodWriteReport;
struct Mask;
struct Mesh;
struct MethodResult;
struct MinComponent;
struct NamedMesh;
struct Normal;
struct Offset;
struct Open;
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
struct Refinement;
struct RepairOptions;
struct RepairReport;
struct Resample;
struct SamplingReport;
struct ShapeOptions;
struct SliceOptions;
struct Smooth;
struct StageTime;
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
struct Line;
struct Scene;
}  // namespace implicit

}  // namespace tufa
