//! Compiles the expressions of a law.

use naga::{BinaryOperator, Expression, Function, Handle, MathFunction, RelationalFunction, TypeInner, UnaryOperator};

use super::{Compiler, bits_of};
use crate::error::Result;
use crate::user_laws::operators::{self, Kind};
use crate::user_laws::program::{Op, Slot};

impl Compiler<'_> {
    fn lanes1(&mut self, apply: fn(u32) -> u32, from: Slot, lanes: usize, is_float: bool) -> Slot {
        let to = self.slot([0; 4]);
        self.push(Op::Lanes1(to, apply, [from], lanes), is_float);
        to
    }

    fn lanes2(&mut self, apply: fn(u32, u32) -> u32, from: [Slot; 2], lanes: usize, is_float: bool) -> Slot {
        let to = self.slot([0; 4]);
        self.push(Op::Lanes2(to, apply, from, lanes), is_float);
        to
    }

    fn gather(&mut self, from: Vec<(Slot, usize)>) -> Slot {
        let to = self.slot([0; 4]);
        self.push(Op::Gather(to, from), false);
        to
    }

    /// Evaluates an expression.
    pub(super) fn emit(&mut self, function: &Function, handle: Handle<Expression>) -> Result<()> {
        let expression = &function.expressions[handle];
        if let Some(range) = function.expressions.get_span(handle).to_range() {
            self.line = self.source.place_in(self.text, range.start).line;
        }
        let is_result = matches!(self.info[self.law][handle].ty.inner_with(&self.module.types), TypeInner::Struct { .. });
        let is_pointer = self.info[self.law][handle].ty.inner_with(&self.module.types).pointer_space().is_some();
        if is_result || is_pointer {
            // Results are taken apart, and pointers are resolved, where they are used.
            return Ok(());
        }
        let (kind, lanes) = self.shape(function, handle)?;
        let slot = match self.gathered(function, expression, lanes)? {
            Some(slot) => slot,
            None => self.computed(function, handle, kind, lanes)?,
        };
        self.values.insert(handle, slot);
        Ok(())
    }

    /// Evaluates an expression that rearranges lanes; `None` for other expressions.
    fn gathered(&mut self, function: &Function, expression: &Expression, lanes: usize) -> Result<Option<Slot>> {
        let slot = match expression {
            Expression::Compose { components, .. } => {
                let mut from = Vec::new();
                for component in components {
                    let slot = self.value(function, *component)?;
                    from.extend((0..self.shape(function, *component)?.1).map(|lane| (slot, lane)));
                }
                self.gather(from)
            }
            Expression::Splat { value, .. } => self.wide(function, *value, lanes)?,
            Expression::AccessIndex { base, index } => {
                let from = self.value(function, *base)?;
                self.gather(vec![(from, *index as usize)])
            }
            Expression::Swizzle { vector, pattern, .. } => {
                let from = self.value(function, *vector)?;
                self.gather(pattern[..lanes].iter().map(|component| (from, *component as usize)).collect())
            }
            Expression::Load { pointer } => {
                let (from, lane) = self.pointer(function, *pointer)?;
                // A copy, because the variable may change before the value is used.
                let first = lane.unwrap_or(0);
                self.gather((0..lanes).map(|lane| (from, first + lane)).collect())
            }
            _ => return Ok(None),
        };
        Ok(Some(slot))
    }

    /// Evaluates an expression that computes numbers.
    fn computed(&mut self, function: &Function, handle: Handle<Expression>, kind: Kind, lanes: usize) -> Result<Slot> {
        let is_float = kind == Kind::Float;
        let not_allowed = |compiler: &Self, what: &str| compiler.refused_expression(function, handle, what);
        let slot = match &function.expressions[handle] {
            Expression::Unary { op, expr } => {
                let from = self.value(function, *expr)?;
                let apply = unary(*op, kind).ok_or_else(|| not_allowed(self, "this operator is not allowed"))?;
                self.lanes1(apply, from, lanes, is_float)
            }
            Expression::Binary { op, left, right } => self.binary(function, handle, *op, [*left, *right])?,
            Expression::Select { condition, accept, reject } => {
                let flags = self.wide(function, *condition, lanes)?;
                let (accept, reject) = (self.value(function, *accept)?, self.value(function, *reject)?);
                let to = self.slot([0; 4]);
                self.push(Op::Lanes3(to, |flag, a, b| if flag != 0 { a } else { b }, [flags, accept, reject], lanes), is_float);
                to
            }
            Expression::Relational { fun: fun @ (RelationalFunction::All | RelationalFunction::Any), argument } => {
                let from = self.value(function, *argument)?;
                let apply = if *fun == RelationalFunction::All { operators::all } else { operators::any };
                let (to, lanes) = (self.slot([0; 4]), self.shape(function, *argument)?.1);
                self.push(Op::Vectors(to, apply, [from; 2], lanes), false);
                to
            }
            Expression::Math { fun, arg, arg1, arg2, .. } => {
                let arguments: Vec<_> = [Some(*arg), *arg1, *arg2].into_iter().flatten().collect();
                self.math(function, handle, *fun, &arguments)?
            }
            Expression::As { expr, convert, .. } => {
                let (from, of) = (self.value(function, *expr)?, self.shape(function, *expr)?.0);
                match convert {
                    None => self.gather((0..lanes).map(|lane| (from, lane)).collect()),
                    Some(_) => self.lanes1(operators::conversion(of, kind), from, lanes, false),
                }
            }
            Expression::Access { .. } => return Err(not_allowed(self, "an index that is not constant is not allowed")),
            Expression::Constant(_) => return Err(not_allowed(self, "a constant of this kind is not allowed")),
            _ => return Err(not_allowed(self, "this expression is not allowed")),
        };
        Ok(slot)
    }

    fn binary(
        &mut self,
        function: &Function,
        handle: Handle<Expression>,
        op: BinaryOperator,
        operands: [Handle<Expression>; 2],
    ) -> Result<Slot> {
        let (result, lanes) = self.shape(function, handle)?;
        let kind = self.shape(function, operands[0])?.0;
        let divides = matches!(op, BinaryOperator::Divide | BinaryOperator::Modulo) && kind != Kind::Float;
        let is_known =
            matches!(&function.expressions[operands[1]], Expression::Literal(literal) if bits_of(*literal) != Some(0));
        if divides && !is_known {
            let message = "an integer may be divided by a constant other than 0 only";
            return Err(self.refused_expression(function, handle, message));
        }
        let apply = operators::binary(op, kind)
            .ok_or_else(|| self.refused_expression(function, handle, "this operator is not allowed"))?;
        let from = [self.wide(function, operands[0], lanes)?, self.wide(function, operands[1], lanes)?];
        Ok(self.lanes2(apply, from, lanes, result == Kind::Float))
    }

    fn math(
        &mut self,
        function: &Function,
        handle: Handle<Expression>,
        fun: MathFunction,
        arguments: &[Handle<Expression>],
    ) -> Result<Slot> {
        let (kind, lanes) = self.shape(function, handle)?;
        let mut from = Vec::new();
        for argument in arguments {
            from.push(self.wide(function, *argument, lanes)?);
        }
        let of = self.shape(function, arguments[0])?;
        let is_float = kind == Kind::Float;
        let to = self.slot([0; 4]);
        let op = match *from.as_slice() {
            [a] => operators::math1(fun, kind)
                .map(|apply| Op::Lanes1(to, apply, [a], lanes))
                .or_else(|| operators::vectors(fun).map(|apply| Op::Vectors(to, apply, [a; 2], of.1))),
            [a, b] => operators::math2(fun, kind)
                .filter(|_| lanes == of.1)
                .map(|apply| Op::Lanes2(to, apply, [a, b], lanes))
                .or_else(|| operators::vectors(fun).map(|apply| Op::Vectors(to, apply, [a, b], of.1))),
            [a, b, c] => operators::math3(fun, kind).map(|apply| Op::Lanes3(to, apply, [a, b, c], lanes)),
            _ => None,
        };
        let op = op.filter(|_| of.0 == kind);
        let name = format!("the function {fun:?} is not allowed here").to_lowercase();
        self.push(op.ok_or_else(|| self.refused_expression(function, handle, &name))?, is_float);
        Ok(to)
    }
}

fn unary(op: UnaryOperator, kind: Kind) -> Option<fn(u32) -> u32> {
    Some(match (op, kind) {
        (UnaryOperator::Negate, Kind::Float) => |a| a ^ 0x8000_0000,
        (UnaryOperator::Negate, Kind::Int) => u32::wrapping_neg,
        (UnaryOperator::LogicalNot, Kind::Bool) => |a| u32::from(a == 0),
        (UnaryOperator::BitwiseNot, Kind::Int | Kind::Uint) => |a| !a,
        _ => return None,
    })
}
