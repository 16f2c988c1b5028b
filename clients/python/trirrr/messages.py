"""The messages of docs/wire.md: fields and variants in their order. Their meanings and units stand there.

Written by ``cargo xtask wire`` from the types of crates/protocol.
"""

from .numbers import POSE, SETPOINT
from .postcard import ANGLE, BOOL, BYTE, F64, I32, N, U16, U32, U64, Bits, Enum, Optional, Sample, Struct, array

#: Version of the protocol.
PROTOCOL = 4

#: Most moves of a batch.
BATCH = 4

#: Most bytes of a block of an image.
BLOCK = 128

#: Most levels of a piece.
LEVELS = 128

#: Bytes of a name.
NAME_CAPACITY = 32

#: Schema keys of the messages, by the number type of the machine.
SCHEMA = {
    "f64": 0xC68063E2A3D8402D,
    "f32": 0x4CE6FE1E5C6E1841,
    "micromath": 0xCCA8AB768A38384D,
    "fixed": 0x41A4868F7F7B2DDB,
}

Hello = Struct("Hello", protocol=U16, schema=U64, scene=U32)

SectionName = Enum("SectionName", Leg=BYTE, Platform=None, Limits=None)

Leg = Struct(
    "Leg",
    base_m=array(F64, 2),
    proximal_m=F64,
    distal_m=F64,
    joint_radius_m=F64,
    joint_angle_rad=F64,
    elbow_positive=BOOL,
    proximal=array(F64, 3),
    distal=array(F64, 3),
    rotor_inertia_kgm2=F64,
    encoder_offset_rad=F64,
)

Platform = Struct(
    "Platform",
    mass_kg=F64,
    inertia_kgm2=F64,
    com_m=array(F64, 2),
    gravity_m_s2=array(F64, 2),
    wrench_force_n=array(F64, 2),
    wrench_torque_nm=F64,
    tool_point_m=array(F64, 2),
)

Limits = Struct(
    "Limits",
    rate_rad_s=Optional(array(F64, 3)),
    acceleration_rad_s2=Optional(array(F64, 3)),
    torque_nm=Optional(array(F64, 3)),
    power_w=Optional(array(F64, 3)),
    jerk_rad_s3=Optional(array(F64, 3)),
    serial_distance_min=F64,
    parallel_distance_min=F64,
)

Section = Enum("Section", Leg={"index": BYTE, "leg": Leg}, Platform=Platform, Limits=Limits)

Move = Struct(
    "Move",
    number=U32,
    from_=POSE,
    to=POSE,
    start_velocity=array(N, 3),
    end_velocity=array(N, 3),
    ticks=U32,
    tool_power=N,
    tool_speed=N,
)

Recovery = Struct("Recovery", to=POSE, ticks=U32)

TelemetryFields = Bits(
    "TelemetryFields",
    U16,
    ("setpoint", "angles", "rates", "accelerations", "torques", "tool", "duration"),
)

#: All of them.
ALL_FIELDS = 127

QuinticMove = Struct("QuinticMove", common=Move, start_acceleration=array(N, 3), end_acceleration=array(N, 3))

Goal = Struct("Goal", to=POSE, velocity=array(N, 3), cut=BOOL, least_ticks=U32)

PathCurve = Enum(
    "PathCurve",
    Line={"to": POSE},
    Arc={"centre": array(N, 2), "turn": N, "to_angle": ANGLE},
    Bezier={"controls": array(POSE, 2), "to": POSE},
)

PathPiece = Struct("PathPiece", number=U32, curve=PathCurve, feed=N, tool_power=N, tool_speed=N, last=BOOL)

ToolSetting = Struct("ToolSetting", power=N, speed=N)

MoveStep = Struct(
    "MoveStep",
    to=POSE,
    velocity=array(N, 3),
    acceleration=Optional(array(N, 3)),
    ticks=U32,
    tool=Optional(ToolSetting),
)

MoveBatch = Struct("MoveBatch", number=U32, check=U32, steps=array(Optional(MoveStep), 4))

JobLabel = Struct("JobLabel", name=array(BYTE, 32), items=U32, check=U32)

LevelPiece = Struct("LevelPiece", first=U32, count=BYTE, levels=array(array(BYTE, 32), 4))

LevelRange = Struct("LevelRange", first=U32, count=U16, offset=U16, span=U32)

ListedMove = Struct("ListedMove", number=U32, check=U32, step=MoveStep, levels=LevelRange)

Firmware = Struct(
    "Firmware",
    version=array(BYTE, 16),
    commit=array(BYTE, 16),
    board=array(BYTE, 32),
    chip=array(BYTE, 16),
)

ImageHeader = Struct("ImageHeader", start=U32, length=U32, checksum=U32, firmware=Firmware)

ImageBlock = Struct("ImageBlock", offset=U32, count=BYTE, bytes=array(array(BYTE, 32), 4))

SceneTypes = Struct("SceneTypes", room=U16, levels=U16, keys=array(U32, 10))

SceneHeader = Struct("SceneHeader", length=U32, checksum=U32, layout=U64, types=SceneTypes)

UpdateStep = Enum("UpdateStep", Begin=ImageHeader, Block=ImageBlock, Finish=None, Restart=None, BeginScene=SceneHeader)

OutputSwitch = Struct("OutputSwitch", number=U32, on=BYTE, off=BYTE)

Command = Enum(
    "Command",
    Hello=Hello,
    Status=None,
    Read=SectionName,
    Replace=Section,
    Move=Move,
    Start=None,
    Hold=None,
    Resume=None,
    Stop=None,
    ClearFault=None,
    Recover=Recovery,
    Telemetry={"every": U16, "fields": TelemetryFields},
    Home=None,
    Quintic=QuinticMove,
    FeedOverride={"percent": BYTE},
    Retarget=Goal,
    Path=PathPiece,
    Enable=None,
    Disable=None,
    Drives={"every": U16},
    Moves=MoveBatch,
    Job=JobLabel,
    Levels=LevelPiece,
    Listed=ListedMove,
    Probe={"away": BOOL},
    UpdateStatus=None,
    Update=UpdateStep,
    Output={"index": BYTE, "on": BOOL},
    OutputsAt=OutputSwitch,
)

Request = Struct("Request", sequence=U32, command=Command)

State = Enum(
    "State",
    Idle=None,
    Running=None,
    Slowing=None,
    Stopping=None,
    Holding=None,
    Fault=None,
    Cleared=None,
    Recovering=None,
    Unhomed=None,
    Homing=None,
    Disabled=None,
    Enabling=None,
    Disabling=None,
    Reacting=None,
)

Quantity = Enum(
    "Quantity",
    Base=None,
    ProximalLength=None,
    DistalLength=None,
    Reach=None,
    JointRadius=None,
    JointAngle=None,
    ProximalMass=None,
    ProximalCentreOfMass=None,
    ProximalInertia=None,
    DistalMass=None,
    DistalCentreOfMass=None,
    DistalInertia=None,
    RotorInertia=None,
    GreatestDetA=None,
    PlatformMass=None,
    PlatformInertia=None,
    PlatformCentreOfMass=None,
    Gravity=None,
    WrenchForce=None,
    WrenchTorque=None,
    SliderDirection=None,
    SliderMass=None,
    RateLimit=None,
    AccelerationLimit=None,
    TorqueLimit=None,
    PowerLimit=None,
    SerialDistance=None,
    ParallelDistance=None,
    JerkLimit=None,
    EncoderOffset=None,
)

Bounded = Enum(
    "Bounded",
    Reach=None,
    SerialDistance=None,
    ParallelDistance=None,
    Rate=None,
    Acceleration=None,
    Torque=None,
    Power=None,
    Range=None,
    Jerk=None,
    AccelerationJump=None,
)

LeastDuration = Struct("LeastDuration", enough=U32, too_short=U32)

Violation = Struct(
    "Violation",
    what=Bounded,
    index=Optional(BYTE),
    at=N,
    value=N,
    error=Optional(N),
    limit=N,
    certain=BOOL,
    ramp=BOOL,
    shortest=Optional(LeastDuration),
)

SceneNeed = Enum(
    "SceneNeed",
    Torques=None,
    PayloadOffset=None,
    Rotors=None,
    LinkMasses=None,
    Gravity=None,
    Quintics=None,
    Jerk=None,
    Paths=None,
    Batches=None,
    PowerLists=None,
    Number=None,
    TickRate=None,
    Drives=None,
    Brake=None,
    ToolOutput=None,
    Inputs=None,
    Lamp=None,
    Homing=None,
    Feedback=None,
    Contact=None,
)

UpdateRefusal = Enum(
    "UpdateRefusal",
    Board=None,
    Chip=None,
    Start={"expected": U32},
    Length={"longest": U32},
    NotBegun=None,
    Block={"expected": U32},
    Checksum={"found": U32},
    Flash={"place": U32, "status": U32},
    JournalFull=None,
    NoScene=None,
    SceneLayout=None,
    SceneNeeds=SceneNeed,
    SceneValue={"quantity": Quantity, "leg": Optional(BYTE)},
    SceneStart=None,
)

Refusal = Enum(
    "Refusal",
    HelloFirst=None,
    Protocol={"expected": U16},
    Schema={"expected": U64},
    Scene={"expected": U32},
    Sequence={"expected": U32},
    SequenceReused=None,
    State=State,
    NothingQueued=None,
    Undecided=None,
    EndsMoving=None,
    QueueFull=None,
    MoveNumber={"expected": U32},
    NotFinite=None,
    Duration={"longest": U32},
    StartPose=None,
    StartVelocity=None,
    Tool=None,
    NotAdjustable=None,
    NoSuchLeg=None,
    Parameter={"quantity": Quantity, "leg": Optional(BYTE)},
    NotInImage=None,
    NoPose=None,
    Recovery=Violation,
    Busy=None,
    NoHoming=None,
    NoQuintics=None,
    StartAcceleration=None,
    FeedOverride=None,
    Retargeting=None,
    NoPaths=None,
    PathUnderWay=None,
    Feed=None,
    NoFeedback=None,
    NoBatches=None,
    Check={"expected": U32},
    NoLevels=None,
    LevelNumber={"expected": U32},
    LevelsFull=None,
    LevelRange=None,
    EmergencyStop=None,
    DoorOpen=None,
    NoProbe=None,
    ProbeTouches=None,
    ProbeOpen=None,
    LimitSwitch={"motor": BYTE},
    NoUpdate=None,
    Update=UpdateRefusal,
    NoOutput={"outputs": BYTE},
    OutputsFull=None,
)

AngleReference = Enum("AngleReference", Declared=None, Blind=None, Homed=None, Measured=None)

Clock = Enum("Clock", Host=None, Crystal=None, Internal=None, Slow=None, Emulated=None, WrongCrystal=None)

Registers = Struct("Registers", pc=U32, lr=U32, sp=U32, status=U32, address=U32)

Start = Enum(
    "Start",
    Power=None,
    Reset=None,
    Watchdog=None,
    Panic={"file": array(BYTE, 32), "line": U32},
    HardFault=Registers,
    StackOverflow=Registers,
    CrystalStopped=None,
    LowSupply=None,
)

Board = Struct("Board", timer_hz=U32, clock=Clock, start=Start)

Identity = Struct(
    "Identity",
    protocol=U16,
    schema=U64,
    scene=U32,
    name=array(BYTE, 32),
    tick_rate_hz=F64,
    length_m=F64,
    time_s=F64,
    mass_kg=F64,
    ramp_ticks=U16,
    silence_ticks=U32,
    queue=U16,
    window=BYTE,
    batch=BYTE,
    next_sequence=U32,
    reference=AngleReference,
    board=Board,
    levels=U16,
    firmware=Firmware,
)

Acting = Enum(
    "Acting",
    Nothing=None,
    Hold=None,
    Resume=None,
    Stop=None,
    Silence=None,
    QueueDry=None,
    Limit=Bounded,
    Door=None,
    Probe=None,
)

DriveFault = Enum(
    "DriveFault",
    StepRate=None,
    Range=None,
    BusBusy=None,
    BusOff=None,
    Reported=None,
    Silent=None,
    NotOn=None,
    Stalled=None,
    Restarted=None,
)

FaultCode = Enum(
    "FaultCode",
    Limit=Bounded,
    Unreachable=None,
    SerialSingular=None,
    ParallelSingular=None,
    OutOfRange=None,
    Overrun=None,
    Drive=DriveFault,
    Board=None,
    HomingNotFound=None,
    HomingNotReleased=None,
    HomingClosedAtStart=None,
    FollowingError=None,
    Contact=None,
    ContactMoment=None,
    EmergencyStop=None,
    LimitSwitch=None,
)

Fault = Struct("Fault", code=FaultCode, index=Optional(BYTE), value=N, limit=N, tick=U32)

Verdict = Struct("Verdict", number=U32, violation=Optional(Violation))

Cut = Struct("Cut", number=U32, at=U32, next=U32)

Interruption = Struct("Interruption", number=U32, at=U32)

JobAccount = Struct("JobAccount", label=JobLabel, first_move=U32, first_piece=U32)

DriveState = Enum("DriveState", Silent=None, Off=None, Preparing=None, On=None, Uncalibrated=None, Fault=None)

NotEnabled = Enum(
    "NotEnabled",
    Drive={"motor": BYTE, "state": DriveState, "error": U32},
    Moves={"motor": BYTE, "value": N, "limit": N},
    NoPose=None,
    ManyPoses=None,
    Singular={"what": Bounded, "leg": Optional(BYTE), "value": N, "limit": N},
    Restarted={"angles": array(Optional(ANGLE), 3)},
)

InputState = Enum("InputState", Absent=None, Clear=None, Active=None)

InputStates = Struct(
    "InputStates",
    emergency_stop=InputState,
    door=InputState,
    probe=InputState,
    limits=array(InputState, 3),
)

ProbeContact = Struct("ProbeContact", tick=U32, pose=POSE, measured=Optional(POSE))

ProbeRun = Enum("ProbeRun", Armed=None, Touched=ProbeContact, NotTouched=None)

DigitalStates = Struct("DigitalStates", inputs=BYTE, outputs=BYTE, tick=U32)

Status = Struct(
    "Status",
    tick=U32,
    state=State,
    acting=Acting,
    fault=Optional(Fault),
    next=U32,
    admitted=U32,
    done=U32,
    piece=U32,
    planning=BOOL,
    room=U16,
    refused=Optional(Verdict),
    end=Optional(SETPOINT),
    lost=U32,
    longest_tick=U32,
    dry_ticks=U32,
    late_ticks=U32,
    longest_stop=U32,
    feed_percent=BYTE,
    cut=Optional(Cut),
    interrupted=Optional(Interruption),
    job=Optional(JobAccount),
    not_enabled=Optional(NotEnabled),
    inputs=InputStates,
    probe=Optional(ProbeRun),
    digital=Optional(DigitalStates),
)

UpdateOutcome = Enum("UpdateOutcome", Never=None, Requested=None, OnTrial=None, Confirmed=None, Reverted=None)

SceneRoom = Struct("SceneRoom", room=U32, layout=U64, types=SceneTypes)

UpdateStatus = Struct(
    "UpdateStatus",
    start=U32,
    room=U32,
    coming=Optional(U32),
    received=U32,
    outcome=UpdateOutcome,
    scene=Optional(SceneRoom),
)

Reply = Enum(
    "Reply",
    Done=None,
    Refused=Refusal,
    Hello=Identity,
    Section=Section,
    Status=Status,
    Kept={"missing": U32},
    Update=UpdateStatus,
)

Event = Enum(
    "Event",
    Verdict=Verdict,
    State={"state": State, "acting": Acting, "done": U32},
    Fault=Fault,
    Inputs=InputStates,
    Probe=ProbeRun,
    Digital=DigitalStates,
)

Telemetry = Sample(
    "Telemetry",
    TelemetryFields,
    tick=U32,
    state=State,
    acting=Acting,
    number=U32,
    at=U32,
    part=U32,
    lost=U32,
    fields=TelemetryFields,
    setpoint=SETPOINT,
    angles=array(ANGLE, 3),
    rates=array(N, 3),
    accelerations=array(N, 3),
    torques=array(N, 3),
    tool=N,
    duration=U32,
)

DriveReading = Struct(
    "DriveReading",
    state=DriveState,
    error=U32,
    angle=ANGLE,
    rate=N,
    torque=N,
    temperature_c=I32,
    supply_mv=U32,
    age=U16,
    state_age=U16,
    restarts=BYTE,
)

DriveSample = Struct("DriveSample", tick=U32, drives=array(DriveReading, 3))

Message = Enum(
    "Message",
    Reply={"sequence": U32, "reply": Reply},
    Event=Event,
    Telemetry=Telemetry,
    Drives=DriveSample,
)
