"""The messages of Foxglove's schemas that show figures, as protobuf; rerun reads some of them too.

Declared here by name and order of their fields, of which all are named: a viewer looks for each.
https://docs.foxglove.dev/docs/visualization/message-schemas/introduction
"""

from typing import Any

from google.protobuf import duration_pb2, timestamp_pb2
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    EnumValueDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass

_TIME, _SPAN = "google.protobuf.Timestamp", "google.protobuf.Duration"
_XYZ = "x:double y:double z:double"
_MESSAGES = {
    "Vector3": _XYZ,
    "Point3": _XYZ,
    "Quaternion": f"{_XYZ} w:double",
    "Pose": "position:Vector3 orientation:Quaternion",
    "Color": "r:double g:double b:double a:double",
    "KeyValuePair": "key:string value:string",
    "FrameTransform": f"timestamp:{_TIME} parent_frame_id:string child_frame_id:string"
    " translation:Vector3 rotation:Quaternion",
    "FrameTransforms": "transforms:FrameTransform*",
    "PackedElementField": "name:string offset:fixed32 type:PackedElementField.NumericType",
    "PointCloud": f"timestamp:{_TIME} frame_id:string pose:Pose point_stride:fixed32"
    " fields:PackedElementField* data:bytes",
    "ArrowPrimitive": "pose:Pose shaft_length:double shaft_diameter:double head_length:double"
    " head_diameter:double color:Color",
    "CubePrimitive": "pose:Pose size:Vector3 color:Color",
    "SpherePrimitive": "pose:Pose size:Vector3 color:Color",
    "CylinderPrimitive": "pose:Pose size:Vector3 bottom_scale:double top_scale:double color:Color",
    "LinePrimitive": "type:LinePrimitive.Type pose:Pose thickness:double scale_invariant:bool"
    " points:Point3* color:Color colors:Color* indices:fixed32*",
    "TriangleListPrimitive": "pose:Pose points:Point3* color:Color colors:Color* indices:fixed32*",
    "TextPrimitive": "pose:Pose billboard:bool font_size:double scale_invariant:bool color:Color"
    " text:string",
    "ModelPrimitive": "pose:Pose scale:Vector3 color:Color override_color:bool url:string"
    " media_type:string data:bytes",
    "SceneEntityDeletion": f"timestamp:{_TIME} type:SceneEntityDeletion.Type id:string",
    "SceneEntity": f"timestamp:{_TIME} frame_id:string id:string lifetime:{_SPAN}"
    " frame_locked:bool metadata:KeyValuePair* arrows:ArrowPrimitive* cubes:CubePrimitive*"
    " spheres:SpherePrimitive* cylinders:CylinderPrimitive* lines:LinePrimitive*"
    " triangles:TriangleListPrimitive* texts:TextPrimitive* models:ModelPrimitive*",
    "SceneUpdate": "deletions:SceneEntityDeletion* entities:SceneEntity*",
}
"""Fields in the order of their numbers; * is repeated."""
_ENUMS = {
    "LinePrimitive": ("Type", "LINE_STRIP LINE_LOOP LINE_LIST"),
    "SceneEntityDeletion": ("Type", "MATCHING_ID ALL"),
    "PackedElementField": (
        "NumericType", "UNKNOWN UINT8 INT8 UINT16 INT16 UINT32 INT32 FLOAT32 FLOAT64",
    ),
}  # fmt: skip
LINE_LIST, FLOAT32 = 2, 7


def _field(number: int, text: str) -> FieldDescriptorProto:
    name, kind = text.removesuffix("*").split(":")
    field = FieldDescriptorProto(name=name, number=number)
    field.label = field.LABEL_REPEATED if text.endswith("*") else field.LABEL_OPTIONAL
    if kind[0].islower() and "." not in kind:
        field.type = getattr(field, f"TYPE_{kind.upper()}")
    else:
        google = kind.startswith("google.")
        field.type = field.TYPE_ENUM if "." in kind and not google else field.TYPE_MESSAGE
        field.type_name = f".{kind}" if google else f".foxglove.{kind}"
    return field


def _message(name: str, fields: str) -> DescriptorProto:
    out = DescriptorProto(name=name)
    out.field.extend(_field(i, text) for i, text in enumerate(fields.split(), 1))
    if name in _ENUMS:
        kind, values = _ENUMS[name]
        named = [EnumValueDescriptorProto(name=v, number=i) for i, v in enumerate(values.split())]
        out.enum_type.append(EnumDescriptorProto(name=kind, value=named))
    return out


def _files() -> FileDescriptorSet:
    ours = FileDescriptorProto(name="a1_studio/figures.proto", package="foxglove", syntax="proto3")
    out = FileDescriptorSet()
    for module in (timestamp_pb2, duration_pb2):
        module.DESCRIPTOR.CopyToProto(out.file.add())
        ours.dependency.append(module.DESCRIPTOR.name)
    ours.message_type.extend(_message(name, fields) for name, fields in _MESSAGES.items())
    out.file.append(ours)
    return out


_set = _files()
_pool = DescriptorPool()
for _file in _set.file:
    _pool.Add(_file)

SCHEMA = _set.SerializeToString()
"""What a protobuf channel of MCAP gives as its schema: a FileDescriptorSet."""


def message(name: str) -> Any:
    """The class of a message of Foxglove's, by its short name."""
    return GetMessageClass(_pool.FindMessageTypeByName(f"foxglove.{name}"))
