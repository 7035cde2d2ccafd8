//! Compiles the WGSL of a law to a [`Program`] for the CPU. It accepts scalars and vectors of `f32`, `i32`, `u32` and `bool`; kernels
//! run without bounds checks, so everything that could reach memory by an index is refused for both backends.

mod expressions;

use std::collections::HashMap;

use naga::valid::{Capabilities, FunctionError, ModuleInfo, ValidationError, ValidationFlags, Validator};
use naga::{Block, Expression, Function, Handle, Literal, LocalVariable, Module, ScalarKind, Statement, TypeInner};

use crate::error::Result;
use crate::user_laws::operators::Kind;
use crate::user_laws::program::{Op, Program, Register, Slot};
use crate::user_laws::source::{Signature, Source, bounded, check, wrapped};

const ONLY: &str =
    "; a law may use scalars and vectors of f32, i32, u32 and bool, operators, built-in functions, if, and loops";

/// Checks the text of a law and compiles it. Returns the function of WGSL, with a limit to its loops, and the program.
pub(super) fn compile(source: Source<'_>, signature: &Signature, parameters: &[&str]) -> Result<(String, Program)> {
    check(source)?;
    // Places in messages are those of the text without limits to loops.
    let plain = wrapped(signature, parameters, source.text);
    Compiler::compile(source, &plain)?;
    let limited = bounded(source.text);
    let function = wrapped(signature, parameters, &limited);
    let program = Compiler::compile(Source { text: &limited, ..source }, &function)?;
    Ok((function, program))
}

fn parse(source: Source<'_>, function: &str) -> Result<(Module, ModuleInfo)> {
    let failed = |byte: Option<usize>, message: String| {
        let end = function.len();
        source.error(source.place_in(function, byte.unwrap_or(end)), message)
    };
    let module = naga::front::wgsl::parse_str(function).map_err(|error| {
        let label = error.labels().next().and_then(|(span, _)| span.to_range());
        failed(label.map(|range| range.start), error.message().to_owned())
    })?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).map_err(|error| {
        // Definitions come before what uses them.
        let known = error.spans().filter_map(|(span, _)| span.to_range()).map(|range| range.start).max();
        let place = statement_of(&module, error.as_inner()).or(known);
        let mut message = String::new();
        let mut cause: Option<&dyn std::error::Error> = Some(error.as_inner());
        while let Some(link) = cause {
            message = link.to_string();
            cause = link.source();
        }
        if message.contains("doesn't match the type stored in") {
            message = "the type of this value is not that of the variable".to_owned();
        }
        failed(place, without_numbers(&message))
    })?;
    Ok((module, info))
}

/// The first byte of the statement that an error is about, where naga names only the values in it.
fn statement_of(module: &Module, error: &ValidationError) -> Option<usize> {
    fn find(block: &Block, is_wanted: &dyn Fn(&Statement) -> bool) -> Option<usize> {
        block.span_iter().find_map(|(statement, span)| {
            let inside = match statement {
                Statement::Block(block) => find(block, is_wanted),
                Statement::If { accept, reject, .. } => find(accept, is_wanted).or_else(|| find(reject, is_wanted)),
                Statement::Loop { body, continuing, .. } => find(body, is_wanted).or_else(|| find(continuing, is_wanted)),
                _ => None,
            };
            inside.or_else(|| if is_wanted(statement) { span.to_range().map(|range| range.start) } else { None })
        })
    }
    let ValidationError::Function { handle, source, .. } = error else { return None };
    let body = &module.functions[*handle].body;
    match source {
        FunctionError::InvalidStoreTypes { pointer: to, value: from } => {
            find(body, &|one| matches!(one, Statement::Store { pointer, value } if pointer == to && value == from))
        }
        FunctionError::InvalidIfType(wanted) => {
            find(body, &|one| matches!(one, Statement::If { condition, .. } if condition == wanted))
        }
        _ => None,
    }
}

/// Removes the numbers of expressions, such as ` [3]`, from a message.
fn without_numbers(message: &str) -> String {
    let mut pieces = message.split(" [");
    let first = pieces.next().unwrap_or_default().to_owned();
    pieces.fold(first, |text, piece| match piece.split_once(']') {
        Some((number, rest)) if number.chars().all(|digit| digit.is_ascii_digit()) => text + rest,
        _ => text + " [" + piece,
    })
}

/// Jumps of a loop whose targets are not known yet.
#[derive(Default)]
struct Jumps {
    breaks: Vec<usize>,
    continues: Vec<usize>,
}

struct Compiler<'a> {
    source: Source<'a>,
    text: &'a str,
    module: &'a Module,
    info: &'a ModuleInfo,
    law: Handle<Function>,
    program: Program,
    /// The registers of expressions and of variables.
    values: HashMap<Handle<Expression>, Slot>,
    variables: HashMap<Handle<LocalVariable>, Slot>,
    loops: Vec<Jumps>,
    line: usize,
}

impl<'a> Compiler<'a> {
    fn compile(source: Source<'a>, text: &'a str) -> Result<Program> {
        let (module, info) = parse(source, text)?;
        let (law, function) = match module.functions.iter().next() {
            Some(first) if module.functions.len() == 1 => first,
            _ => return Err(source.error(source.place_in(text, 0), "a law is the body of one function")),
        };
        let mut compiler = Compiler {
            source,
            text,
            module: &module,
            info: &info,
            law,
            program: Program::default(),
            values: HashMap::new(),
            variables: HashMap::new(),
            loops: Vec::new(),
            line: 0,
        };
        compiler.function(function)?;
        Ok(compiler.program)
    }

    fn function(&mut self, function: &Function) -> Result<()> {
        for _ in &function.arguments {
            let slot = self.slot([0; 4]);
            self.program.arguments.push(slot);
        }
        for (handle, variable) in function.local_variables.iter() {
            let place = function.local_variables.get_span(handle).to_range();
            self.shape_of(&self.module.types[variable.ty].inner)
                .ok_or_else(|| self.refused(place, "this type is not allowed"))?;
            let slot = self.slot([0; 4]);
            self.variables.insert(handle, slot);
        }
        for (handle, variable) in function.local_variables.iter() {
            if let Some(start) = variable.init {
                let from = self.value(function, start)?;
                self.copy(self.variables[&handle], from);
            }
        }
        self.block(function, &function.body)
    }

    fn refused(&self, range: Option<std::ops::Range<usize>>, message: &str) -> crate::Error {
        let place = self.source.place_in(self.text, range.map_or(self.text.len(), |range| range.start));
        self.source.error(place, format!("{message}{ONLY}"))
    }

    fn refused_expression(&self, function: &Function, handle: Handle<Expression>, message: &str) -> crate::Error {
        self.refused(function.expressions.get_span(handle).to_range(), message)
    }

    fn slot(&mut self, start: Register) -> Slot {
        self.program.start.push(start);
        self.program.start.len() - 1
    }

    fn push(&mut self, op: Op, is_float: bool) {
        self.program.ops.push(op);
        self.program.lines.push((self.line, is_float));
    }

    fn copy(&mut self, to: Slot, from: Slot) {
        self.push(Op::Gather(to, (0..4).map(|lane| (from, lane)).collect()), false);
    }

    /// Kind and number of lanes of a type; `None` for other types.
    fn shape_of(&self, inner: &TypeInner) -> Option<(Kind, usize)> {
        let (scalar, lanes) = match *inner {
            TypeInner::Scalar(scalar) => (scalar, 1),
            TypeInner::Vector { size, scalar } => (scalar, size as usize),
            _ => return None,
        };
        let kind = match (scalar.kind, scalar.width) {
            (ScalarKind::Float, 4) => Kind::Float,
            (ScalarKind::Sint, 4) => Kind::Int,
            (ScalarKind::Uint, 4) => Kind::Uint,
            (ScalarKind::Bool, _) => Kind::Bool,
            _ => return None,
        };
        Some((kind, lanes))
    }

    fn shape(&self, function: &Function, handle: Handle<Expression>) -> Result<(Kind, usize)> {
        let inner = self.info[self.law][handle].ty.inner_with(&self.module.types);
        self.shape_of(inner).ok_or_else(|| self.refused_expression(function, handle, "this type is not allowed"))
    }

    fn block(&mut self, function: &Function, block: &Block) -> Result<()> {
        for (statement, span) in block.span_iter() {
            let range = span.to_range();
            if let Some(range) = &range {
                self.line = self.source.place_in(self.text, range.start).line;
            }
            self.statement(function, statement, range)?;
        }
        Ok(())
    }

    fn statement(&mut self, function: &Function, statement: &Statement, range: Option<std::ops::Range<usize>>) -> Result<()> {
        match statement {
            Statement::Emit(handles) => {
                for handle in handles.clone() {
                    self.emit(function, handle)?;
                }
            }
            Statement::Block(block) => self.block(function, block)?,
            Statement::If { condition, accept, reject } => {
                let flag = self.value(function, *condition)?;
                let skips = self.jump_unless(flag);
                self.block(function, accept)?;
                let ends = self.jump();
                self.land(&[skips]);
                self.block(function, reject)?;
                self.land(&[ends]);
            }
            Statement::Loop { body, continuing, break_if } => {
                self.loops.push(Jumps::default());
                let start = self.program.ops.len();
                self.block(function, body)?;
                let continues = self.loops.last_mut().map(|jumps| std::mem::take(&mut jumps.continues)).unwrap_or_default();
                self.land(&continues);
                self.block(function, continuing)?;
                if let Some(condition) = break_if {
                    let flag = self.value(function, *condition)?;
                    self.push(Op::JumpUnless(flag, start), false);
                } else {
                    self.push(Op::Jump(start), false);
                }
                let breaks = self.loops.pop().unwrap_or_default().breaks;
                self.land(&breaks);
            }
            Statement::Break => {
                let jump = self.jump();
                self.loops.last_mut().into_iter().for_each(|jumps| jumps.breaks.push(jump));
            }
            Statement::Continue => {
                let jump = self.jump();
                self.loops.last_mut().into_iter().for_each(|jumps| jumps.continues.push(jump));
            }
            Statement::Store { pointer, value } => self.store(function, *pointer, *value)?,
            Statement::Return { value: Some(result) } => {
                let Expression::Compose { components, .. } = &function.expressions[*result] else {
                    return Err(self.refused(range, "a law does not return by itself"));
                };
                for component in components {
                    let slot = self.value(function, *component)?;
                    self.program.results.push(slot);
                }
            }
            _ => return Err(self.refused(range, "this statement is not allowed")),
        }
        Ok(())
    }

    fn jump(&mut self) -> usize {
        self.push(Op::Jump(0), false);
        self.program.ops.len() - 1
    }

    fn jump_unless(&mut self, flag: Slot) -> usize {
        self.push(Op::JumpUnless(flag, 0), false);
        self.program.ops.len() - 1
    }

    /// Makes jumps lead to the next operation.
    fn land(&mut self, jumps: &[usize]) {
        let here = self.program.ops.len();
        for jump in jumps {
            if let Op::Jump(target) | Op::JumpUnless(_, target) = &mut self.program.ops[*jump] {
                *target = here;
            }
        }
    }

    fn store(&mut self, function: &Function, pointer: Handle<Expression>, value: Handle<Expression>) -> Result<()> {
        let from = self.value(function, value)?;
        let (to, lane) = self.pointer(function, pointer)?;
        match lane {
            None => self.copy(to, from),
            Some(lane) => self.push(Op::StoreLane(to, lane, from), false),
        }
        Ok(())
    }

    /// The variable, or the lane of one, that a pointer refers to.
    fn pointer(&self, function: &Function, pointer: Handle<Expression>) -> Result<(Slot, Option<usize>)> {
        match &function.expressions[pointer] {
            Expression::LocalVariable(variable) => Ok((self.variables[variable], None)),
            Expression::AccessIndex { base, index } => match self.pointer(function, *base)? {
                (slot, None) => Ok((slot, Some(*index as usize))),
                _ => Err(self.refused_expression(function, pointer, "this type is not allowed")),
            },
            Expression::Access { .. } => {
                Err(self.refused_expression(function, pointer, "an index that is not constant is not allowed"))
            }
            _ => Err(self.refused_expression(function, pointer, "this pointer is not allowed")),
        }
    }

    /// The register of an expression. Constants are computed when they are used first.
    fn value(&mut self, function: &Function, handle: Handle<Expression>) -> Result<Slot> {
        if let Some(slot) = self.values.get(&handle) {
            return Ok(*slot);
        }
        let slot = match &function.expressions[handle] {
            Expression::FunctionArgument(place) => self.program.arguments[*place as usize],
            Expression::Literal(literal) => {
                let literal = *literal;
                let bits =
                    bits_of(literal).ok_or_else(|| self.refused_expression(function, handle, "this type is not allowed"))?;
                self.slot([bits, 0, 0, 0])
            }
            Expression::ZeroValue(_) => {
                self.shape(function, handle)?;
                self.slot([0; 4])
            }
            _ => {
                self.emit(function, handle)?;
                // Pointers and structs have no register.
                let known = self.values.get(&handle).copied();
                return known.ok_or_else(|| self.refused_expression(function, handle, "this type is not allowed"));
            }
        };
        self.values.insert(handle, slot);
        Ok(slot)
    }

    /// The register of an operand with a number of lanes: that of a scalar is repeated.
    fn wide(&mut self, function: &Function, handle: Handle<Expression>, lanes: usize) -> Result<Slot> {
        let from = self.value(function, handle)?;
        if lanes == 1 || self.shape(function, handle)?.1 > 1 {
            return Ok(from);
        }
        let to = self.slot([0; 4]);
        self.push(Op::Gather(to, vec![(from, 0); lanes]), false);
        Ok(to)
    }
}

fn bits_of(literal: Literal) -> Option<u32> {
    match literal {
        Literal::F32(number) => Some(number.to_bits()),
        Literal::I32(number) => Some(number.cast_unsigned()),
        Literal::U32(number) => Some(number),
        Literal::Bool(flag) => Some(u32::from(flag)),
        _ => None,
    }
}
