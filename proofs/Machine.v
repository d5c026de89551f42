(* A machine of passive elements is passive: bodies, joined by any number of elements, each of which sees the machine
   along a direction. *)
From Coq Require Import Reals Lra Psatz List.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Motion Continuous.
Open Scope R_scope.

(* --- sums over lists ------------------------------------------------------------------------------------------------------- *)

Definition total {A : Type} (l : list A) (h : A -> R) : R := fold_right (fun x s => h x + s) 0 l.

Lemma total_ext {A} (l : list A) h k : (forall x, In x l -> h x = k x) -> total l h = total l k.
Proof.
  induction l as [|x l IH]; intros E; simpl; [reflexivity|].
  rewrite E by (left; reflexivity). rewrite IH; [reflexivity|]. intros y Hy. apply E. right; exact Hy.
Qed.
Lemma total_plus {A} (l : list A) h k : total l (fun x => h x + k x) = total l h + total l k.
Proof. induction l as [|x l IH]; simpl; [lra|]. rewrite IH. lra. Qed.
Lemma total_minus {A} (l : list A) h k : total l (fun x => h x - k x) = total l h - total l k.
Proof. induction l as [|x l IH]; simpl; [lra|]. rewrite IH. lra. Qed.
Lemma total_scal {A} (l : list A) c h : total l (fun x => c * h x) = c * total l h.
Proof. induction l as [|x l IH]; simpl; [lra|]. rewrite IH. lra. Qed.
Lemma total_le {A} (l : list A) h k : (forall x, In x l -> h x <= k x) -> total l h <= total l k.
Proof.
  induction l as [|x l IH]; intros E; simpl; [lra|].
  pose proof (E x (or_introl eq_refl)). assert (total l h <= total l k) by (apply IH; intros y Hy; apply E; right; exact Hy). lra.
Qed.
Lemma total_0 {A} (l : list A) : total l (fun _ => 0) = 0.
Proof. induction l as [|x l IH]; simpl; lra. Qed.
Lemma total_nonneg {A} (l : list A) h : (forall x, In x l -> 0 <= h x) -> 0 <= total l h.
Proof. intros H. rewrite <- (total_0 l). apply total_le. exact H. Qed.
Lemma total_swap {A B} (l : list A) (k : list B) (h : A -> B -> R) :
  total l (fun x => total k (h x)) = total k (fun y => total l (fun x => h x y)).
Proof.
  induction l as [|x l IH]; simpl; [rewrite total_0; reflexivity|]. rewrite IH, <- total_plus. reflexivity.
Qed.

(* --- piecewise continuous functions of time ------------------------------------------------------------------------------------ *)

Definition smooth_inside (h : R -> R) (a b : R) : Prop :=
  exists h', (forall t, continuous (T := R_UniformSpace) (U := R_UniformSpace) h' t) /\ forall t, a < t < b -> h t = h' t.

Lemma inside_const c a b : smooth_inside (fun _ => c) a b.
Proof. exists (fun _ => c). split; [intros; apply continuous_const|reflexivity]. Qed.
Lemma inside_plus h k a b : smooth_inside h a b -> smooth_inside k a b -> smooth_inside (fun t => h t + k t) a b.
Proof.
  intros (h' & Ch & Eh) (k' & Ck & Ek). exists (fun t => h' t + k' t). split.
  - intros t. apply (continuous_plus h' k'); auto.
  - intros t Ht. rewrite Eh, Ek by exact Ht. reflexivity.
Qed.
Lemma inside_minus h k a b : smooth_inside h a b -> smooth_inside k a b -> smooth_inside (fun t => h t - k t) a b.
Proof.
  intros (h' & Ch & Eh) (k' & Ck & Ek). exists (fun t => h' t - k' t). split.
  - intros t. apply (continuous_minus h' k'); auto.
  - intros t Ht. rewrite Eh, Ek by exact Ht. reflexivity.
Qed.
Lemma inside_mult h k a b : smooth_inside h a b -> smooth_inside k a b -> smooth_inside (fun t => h t * k t) a b.
Proof.
  intros (h' & Ch & Eh) (k' & Ck & Ek). exists (fun t => h' t * k' t). split.
  - intros t. apply (continuous_mult h' k'); auto.
  - intros t Ht. rewrite Eh, Ek by exact Ht. reflexivity.
Qed.
Lemma inside_total {A} (l : list A) (h : A -> R -> R) a b : (forall x, In x l -> smooth_inside (h x) a b) ->
  smooth_inside (fun t => total l (fun x => h x t)) a b.
Proof.
  induction l as [|x l IH]; intros H; simpl; [apply inside_const|].
  apply (inside_plus (h x)); [apply H; left; reflexivity|]. apply IH. intros y Hy. apply H. right; exact Hy.
Qed.
Lemma inside_integrable h a b : a <= b -> smooth_inside h a b -> ex_RInt h a b.
Proof. intros Hab (h' & C & E). apply (ex_RInt_piece h h' a b Hab C E). Qed.

(* The integral of a derivative that is known inside only. *)
Lemma integral_of_derivative (T p : R -> R) a b : a <= b -> smooth_inside p a b ->
  (forall t, a <= t <= b -> continuous T t) -> (forall t, a < t < b -> is_derive T t (p t)) ->
  T b - T a = RInt p a b.
Proof.
  intros Hab (p' & C & E) HT HD. destruct (ex_RInt_piece p p' a b Hab C E) as [_ ->].
  assert (S : T b - RInt p' a b = T a - RInt p' a a).
  { apply (steady (fun t => T t - RInt p' a t) a b Hab).
    - intros t Ht. apply (continuous_minus T (RInt p' a)); [apply HT; exact Ht|].
      apply (is_derive_continuous _ t (p' t)). apply is_derive_integral. exact C.
    - intros t Ht. evar_last; [apply (is_derive_minus T (RInt p' a)); [apply HD; exact Ht|apply is_derive_integral; exact C]|].
      rewrite E by exact Ht. apply (minus_eq_zero (p' t)). }
  rewrite RInt_point in S. unfold zero in S; simpl in S. lra.
Qed.

Lemma RInt_total {A} (l : list A) (h : A -> R -> R) a b : (forall x, In x l -> ex_RInt (h x) a b) ->
  ex_RInt (fun t => total l (fun x => h x t)) a b /\
  RInt (fun t => total l (fun x => h x t)) a b = total l (fun x => RInt (h x) a b).
Proof.
  induction l as [|x l IH]; intros H; simpl.
  - split; [apply ex_RInt_const|]. rewrite RInt_const. unfold scal; simpl. unfold mult; simpl. ring.
  - destruct IH as [X I]; [intros y Hy; apply H; right; exact Hy|].
    assert (Hx : ex_RInt (h x) a b) by (apply H; left; reflexivity). split.
    + apply (ex_RInt_plus (h x)); assumption.
    + rewrite (RInt_plus (h x)) by assumption. rewrite I. reflexivity.
Qed.

(* --- elements ------------------------------------------------------------------------------------------------------------------- *)

(* An element has one state x, dx/dt = rate u x, and a force; its input u holds the speed w = vel u, and more where, for
   example, the level of its friction varies. *)
Record element := {
  input : UniformSpace; vel : input -> R; rate : input -> R -> R; force : input -> R -> R; ok : input -> Prop;
  domain : R -> Prop }.
Definition element_power (e : element) (u : input e) (x : R) : R := force e u x * vel e u.
Definition acts_inside_pieces (e : element) : Prop :=
  forall u x a b, piece (rate e) u x a b -> (forall t, a < t < b -> ok e (u t)) ->
  smooth_inside (fun t => force e (u t) (x t)) a b.
Definition stores_in (e : element) (S : R -> R) : Prop :=
  acts_inside_pieces e /\ (forall w, continuous (vel e) w) /\ storage (rate e) (ok e) (element_power e) (domain e) S.

(* Contacts: any law of friction. *)
Definition contact (dz F : R -> R -> R) (dom : R -> Prop) : element :=
  {| input := R_UniformSpace; vel := fun v => v; rate := dz; force := F; ok := any; domain := dom |}.

(* A spring and a damper. *)
Definition spring (k c : R) : element :=
  {| input := R_UniformSpace; vel := fun w => w; rate := fun w _ => w; force := fun w d => k * d + c * w; ok := any;
     domain := any |}.

(* With play of half width h: the spring acts beyond it; the damper acts in contact only, and never pulls. *)
Definition beyond (h d : R) : R := Rmax 0 (d - h) - Rmax 0 (- d - h).
Definition limited (x m : R) : R := Rmax (- m) (Rmin m x).
Definition spring_with_play (k c h : R) : element :=
  {| input := R_UniformSpace; vel := fun w => w; rate := fun w _ => w;
     force := fun w d => k * beyond h d + limited (c * w) (Rabs (k * beyond h d)); ok := any; domain := any |}.

(* Gravity on an arm: the load -amplitude sin(y + phase), as an element's force. *)
Definition pendulum (amplitude phase : R) : element :=
  {| input := R_UniformSpace; vel := fun w => w; rate := fun w _ => w; force := fun _ d => amplitude * sin (d + phase);
     ok := any; domain := any |}.

Lemma c_input : continuous_2 (U := R_UniformSpace) (fun w _ => w).
Proof. apply (c_fst (U := R_UniformSpace) (fun w : R => w)). intros w. apply continuous_id. Qed.

Theorem contact_stores dz F dom S : continuous_2 (U := R_UniformSpace) F ->
  storage (U := R_UniformSpace) dz any (power_of F) dom S -> stores_in (contact dz F dom) S.
Proof.
  intros C H. split; [|split; [intros w; apply continuous_id|exact H]].
  intros u x a b P _. exact (piece_power dz F u x a b P C).
Qed.

Lemma by_storage (F : R -> R -> R) (S S' : R -> R) : continuous_2 (U := R_UniformSpace) F ->
  (forall d, is_derive S d (S' d)) -> (forall d, 0 <= S d) -> (forall w d, S' d * w <= F w d * w) ->
  stores_in {| input := R_UniformSpace; vel := fun w => w; rate := fun w _ => w; force := F; ok := any; domain := any |} S.
Proof.
  intros C HS H0 HD. split; [intros u x a b P _; exact (piece_power _ F u x a b P C)|].
  split; [intros w; apply continuous_id|].
  apply storage_by with S'; auto.
  - apply (c_mult (U := R_UniformSpace) F (fun w _ => w)); [exact C|exact c_input].
  - intros w d _ _. apply HD.
Qed.

Theorem spring_stores k c : 0 <= k -> 0 <= c -> stores_in (spring k c) (fun d => k * (d * d) / 2).
Proof.
  intros Hk Hc. apply by_storage with (fun d => k * d).
  - pose proof c_input. cont.
  - intros d. auto_derive; [exact I|field].
  - intros d. pose proof (Rle_0_sqr d) as Q. unfold Rsqr in Q. nra.
  - intros w d. pose proof (Rle_0_sqr w) as Q. unfold Rsqr in Q. nra.
Qed.

Lemma limited_sign x m : 0 <= m -> 0 <= x * limited x m.
Proof.
  intros Hm. unfold limited, Rmax, Rmin. destruct (Rle_dec m x); [destruct (Rle_dec (- m) m)|destruct (Rle_dec (- m) x)]; nra.
Qed.

Lemma is_derive_beyond h d : 0 <= h ->
  is_derive (fun d => (Rmax 0 (d - h) * Rmax 0 (d - h) + Rmax 0 (- d - h) * Rmax 0 (- d - h)) / 2) d (beyond h d).
Proof.
  intros Hh. set (q := fun x => Rmax 0 x * Rmax 0 x).
  assert (Q : forall x, is_derive q x (2 * Rmax 0 x)) by apply is_derive_positive_part_squared.
  assert (D1 : is_derive (fun d => d - h) d 1) by (auto_derive; [exact I|ring]).
  assert (D2 : is_derive (fun d => - d - h) d (- 1)) by (auto_derive; [exact I|ring]).
  apply (is_derive_ext (fun d => / 2 * (q (d - h) + q (- d - h)))); [intros x; apply Rmult_comm|].
  evar_last.
  - apply is_derive_scal. apply (is_derive_plus (fun d => q (d - h)) (fun d => q (- d - h))).
    + apply (is_derive_comp q (fun d => d - h)); [apply Q|exact D1].
    + apply (is_derive_comp q (fun d => - d - h)); [apply Q|exact D2].
  - unfold beyond, plus, scal; simpl. unfold mult; simpl. field.
Qed.

Theorem spring_with_play_stores k c h : 0 <= k -> 0 <= c -> 0 <= h ->
  stores_in (spring_with_play k c h) (fun d => k * ((Rmax 0 (d - h) * Rmax 0 (d - h) + Rmax 0 (- d - h) * Rmax 0 (- d - h)) / 2)).
Proof.
  intros Hk Hc Hh. apply by_storage with (fun d => k * beyond h d).
  - unfold limited, beyond. pose proof c_input. cont.
  - intros d. apply (is_derive_scal (fun d => (Rmax 0 (d - h) * Rmax 0 (d - h) + Rmax 0 (- d - h) * Rmax 0 (- d - h)) / 2)).
    apply is_derive_beyond. exact Hh.
  - intros d. apply Rmult_le_pos; [exact Hk|]. pose proof (Rle_0_sqr (Rmax 0 (d - h))). pose proof (Rle_0_sqr (Rmax 0 (- d - h))).
    unfold Rsqr in *. lra.
  - intros w d. pose proof (Rabs_pos (k * beyond h d)) as A.
    set (m := Rabs (k * beyond h d)) in *. enough (0 <= limited (c * w) m * w) by nra.
    destruct Hc as [Hc | <-].
    + pose proof (limited_sign (c * w) m A). apply Rmult_le_reg_l with c; [exact Hc|]. rewrite Rmult_0_r. nra.
    + unfold limited. rewrite Rmult_0_l, Rmin_right, Rmax_right by lra. lra.
Qed.

Theorem pendulum_stores amplitude phase : 0 <= amplitude ->
  stores_in (pendulum amplitude phase) (fun d => amplitude * (1 - cos (d + phase))).
Proof.
  intros Ha. apply by_storage with (fun d => amplitude * sin (d + phase)).
  - pose proof c_input. cont.
  - intros d. auto_derive; [exact I|ring].
  - intros d. pose proof (COS_bound (d + phase)). nra.
  - intros w d. lra.
Qed.

(* --- machines --------------------------------------------------------------------------------------------------------------------- *)
Section Machine.
Variables (B A : Type) (bodies : list B) (elements : list A).
Variables (mass : B -> R) (kind : A -> element) (direction : A -> B -> R).
(* what acts from outside: loads, motors and controllers on bodies; far ends that are moved *)
Variables (load : B -> R -> R) (moved : A -> R -> R).
Variables (v : B -> R -> R) (u : forall e : A, R -> input (kind e)) (x : A -> R -> R).

Definition acts (e : A) (t : R) : R := force (kind e) (u e t) (x e t).
Definition speed (e : A) (t : R) : R := vel (kind e) (u e t).

(* M dv/dt = loads - sum of b f, and each element sees w = b . v, plus the speed of an end that is moved. *)
Definition machine_piece (a b : R) : Prop :=
  a < b /\
  (forall e, In e elements -> piece (rate (kind e)) (u e) (x e) a b) /\
  (forall e, In e elements -> smooth_inside (moved e) a b) /\
  (forall i, In i bodies -> smooth_inside (load i) a b) /\
  (forall i, In i bodies -> exists v', (forall t, continuous (T := R_UniformSpace) (U := R_UniformSpace) v' t) /\
    forall t, a <= t <= b -> v i t = v' t) /\
  (forall t, a < t < b ->
    (forall e, In e elements -> ok (kind e) (u e t) /\ speed e t = total bodies (fun i => direction e i * v i t) + moved e t) /\
    (forall i, In i bodies -> exists dv, is_derive (v i) t dv /\
      mass i * dv = load i t - total elements (fun e => direction e i * acts e t))).

Inductive machine_motion : R -> R -> Prop :=
  | machine_at_once a : machine_motion a a
  | machine_onward a b c : machine_motion a b -> machine_piece b c -> machine_motion a c.

Definition kinetic (t : R) : R := total bodies (fun i => mass i * (v i t * v i t) / 2).
Definition supplied (t : R) : R := total bodies (fun i => load i t * v i t) + total elements (fun e => acts e t * moved e t).
Definition taken (t : R) : R := total elements (fun e => acts e t * speed e t).

Lemma machine_motion_of e a b : In e elements -> machine_motion a b -> motion (rate (kind e)) (u e) (x e) a b.
Proof.
  intros He M. induction M as [a | a b c M IH (_ & P & _)]; [apply at_once|]. apply onward with b; auto.
Qed.

(* What flows into the bodies is what is supplied less what the elements take: directions cancel. *)
Lemma power_balance t : (forall e, In e elements -> speed e t = total bodies (fun i => direction e i * v i t) + moved e t) ->
  total bodies (fun i => (load i t - total elements (fun e => direction e i * acts e t)) * v i t) = supplied t - taken t.
Proof.
  intros W. unfold supplied, taken.
  rewrite (total_ext bodies _ (fun i => load i t * v i t - total elements (fun e => acts e t * (direction e i * v i t)))).
  2: { intros i _. rewrite (total_ext elements (fun e => acts e t * (direction e i * v i t))
         (fun e => v i t * (direction e i * acts e t))) by (intros; ring). rewrite total_scal. ring. }
  rewrite total_minus, (total_swap bodies elements (fun i e => acts e t * (direction e i * v i t))).
  rewrite (total_ext elements (fun e => acts e t * speed e t)
    (fun e => acts e t * total bodies (fun i => direction e i * v i t) + acts e t * moved e t)).
  2: { intros e He. rewrite W by exact He. ring. }
  rewrite total_plus.
  rewrite (total_ext elements (fun y => total bodies (fun i => acts y t * (direction y i * v i t)))
    (fun e => acts e t * total bodies (fun i => direction e i * v i t))); [lra|].
  intros e _. apply total_scal.
Qed.

Variable S : A -> R -> R.
Hypothesis stores : forall e, In e elements -> stores_in (kind e) (S e).

Lemma acts_inside e a b : In e elements -> machine_piece a b -> smooth_inside (acts e) a b /\ smooth_inside (speed e) a b.
Proof.
  intros He (_ & P & _ & _ & _ & HE). destruct (stores e He) as (C & V & _). pose proof (P e He) as Pe. split.
  - apply (C (u e) (x e) a b Pe). intros t Ht. apply HE; assumption.
  - apply (piece_power (rate (kind e)) (fun w _ => vel (kind e) w) (u e) (x e) a b Pe). apply c_fst. exact V.
Qed.

Lemma body_gains i a b : In i bodies -> machine_piece a b ->
  ex_RInt (fun t => (load i t - total elements (fun e => direction e i * acts e t)) * v i t) a b /\
  mass i * (v i b * v i b) / 2 - mass i * (v i a * v i a) / 2 =
  RInt (fun t => (load i t - total elements (fun e => direction e i * acts e t)) * v i t) a b.
Proof.
  intros Hi P. pose proof P as (Hab & _ & _ & HL & HV & HE). destruct (HV i Hi) as (v' & Cv & Ev).
  set (net := fun t => load i t - total elements (fun e => direction e i * acts e t)).
  assert (Iv : smooth_inside (v i) a b) by (exists v'; split; [exact Cv|intros t Ht; apply Ev; lra]).
  assert (In_ : smooth_inside (fun t => net t * v i t) a b).
  { apply inside_mult; [|exact Iv]. apply inside_minus; [apply HL; exact Hi|].
    apply inside_total. intros e He. apply inside_mult; [apply inside_const|]. apply acts_inside; assumption. }
  split; [apply inside_integrable; [lra|exact In_]|].
  rewrite !Ev by lra.
  apply (integral_of_derivative (fun t => mass i * (v' t * v' t) / 2) (fun t => net t * v i t)); [lra|exact In_| |].
  - intros t _. apply (continuous_mult (fun t => mass i * (v' t * v' t)) (fun _ => / 2)); [|apply continuous_const].
    apply (continuous_mult (fun _ => mass i) (fun t => v' t * v' t)); [apply continuous_const|].
    apply (continuous_mult v' v'); apply Cv.
  - intros t Ht. destruct (HE t Ht) as [_ HB]. destruct (HB i Hi) as (dv & D & E).
    assert (D' : is_derive v' t dv) by (apply (near (v i) v' a b); assumption).
    apply (is_derive_ext (fun t => mass i / 2 * (v' t * v' t))); [intros s; unfold Rdiv; simpl; ring|].
    evar_last.
    + apply is_derive_scal. apply (is_derive_mult v' v' t dv dv D' D'). intros; apply Rmult_comm.
    + unfold net. rewrite <- E, Ev by lra. unfold plus, mult, scal; simpl. unfold mult; simpl. field.
Qed.

Lemma piece_balance a b : machine_piece a b -> ex_RInt supplied a b /\ ex_RInt taken a b /\
  kinetic b - kinetic a = RInt supplied a b - RInt taken a b.
Proof.
  intros P. pose proof P as (Hab & _ & HM & HL & HV & HE).
  assert (X1 : ex_RInt supplied a b).
  { apply inside_integrable; [lra|]. apply inside_plus; apply inside_total.
    - intros i Hi. apply inside_mult; [apply HL; exact Hi|]. destruct (HV i Hi) as (v' & Cv & Ev).
      exists v'. split; [exact Cv|]. intros t Ht. apply Ev. lra.
    - intros e He. apply inside_mult; [apply acts_inside|apply HM]; assumption. }
  assert (X2 : ex_RInt taken a b).
  { apply inside_integrable; [lra|]. apply inside_total. intros e He. apply inside_mult; apply acts_inside; assumption. }
  split; [exact X1|]. split; [exact X2|]. unfold kinetic. rewrite <- total_minus.
  rewrite (total_ext bodies _ (fun i => RInt (fun t => (load i t - total elements (fun e => direction e i * acts e t)) * v i t) a b)).
  2: { intros i Hi. apply body_gains; assumption. }
  destruct (RInt_total bodies (fun i t => (load i t - total elements (fun e => direction e i * acts e t)) * v i t) a b) as [_ <-].
  { intros i Hi. apply body_gains; assumption. }
  rewrite (RInt_ext _ (fun t => minus (supplied t) (taken t))).
  - rewrite (RInt_minus supplied taken) by assumption. reflexivity.
  - intros t Ht. rewrite Rmin_left, Rmax_right in Ht by lra. apply power_balance. intros e He. apply HE; assumption.
Qed.

Lemma motion_balance a b : machine_motion a b -> ex_RInt supplied a b /\ ex_RInt taken a b /\
  kinetic b - kinetic a = RInt supplied a b - RInt taken a b.
Proof.
  intros M. induction M as [a | a b c M (X1 & X2 & I) P].
  - repeat split; try apply ex_RInt_point. rewrite !RInt_point. unfold zero; simpl. lra.
  - destruct (piece_balance b c P) as (Y1 & Y2 & J).
    split; [apply (ex_RInt_Chasles supplied a b c); assumption|].
    split; [apply (ex_RInt_Chasles taken a b c); assumption|].
    rewrite <- (RInt_Chasles supplied a b c), <- (RInt_Chasles taken a b c) by assumption. unfold plus; simpl. lra.
Qed.

Definition machine_stored (t : R) : R := kinetic t + total elements (fun e => S e (x e t)).

(* The energy in bodies and elements rises by no more than what loads, motors, controllers and moved ends supply. *)
Theorem machine_passive a b : machine_motion a b ->
  (forall e, In e elements -> forall t, a <= t <= b -> ok (kind e) (u e t)) ->
  (forall e, In e elements -> domain (kind e) (x e a)) ->
  ex_RInt supplied a b /\ machine_stored b - machine_stored a <= RInt supplied a b.
Proof.
  intros M Hok Hdom. destruct (motion_balance a b M) as (X1 & X2 & I). split; [exact X1|].
  assert (E : forall e, In e elements -> ex_RInt (fun t => acts e t * speed e t) a b /\
    S e (x e b) - S e (x e a) <= RInt (fun t => acts e t * speed e t) a b).
  { intros e He. destruct (stores e He) as (_ & _ & _ & St).
    apply (St (u e) (x e) a b); [apply machine_motion_of; assumption|apply Hok; exact He|apply Hdom; exact He]. }
  destruct (RInt_total elements (fun e t => acts e t * speed e t) a b) as [_ J]; [intros e He; apply E; exact He|].
  unfold machine_stored. assert (T : RInt taken a b = total elements (fun e => RInt (fun t => acts e t * speed e t) a b)) by exact J.
  assert (L : total elements (fun e => S e (x e b)) - total elements (fun e => S e (x e a)) <= RInt taken a b).
  { rewrite T, <- total_minus. apply total_le. intros e He. apply E. exact He. }
  lra.
Qed.

Theorem machine_stored_nonneg t : (forall i, In i bodies -> 0 <= mass i) ->
  (forall e, In e elements -> domain (kind e) (x e t)) -> 0 <= machine_stored t.
Proof.
  intros Hm Hdom. apply Rplus_le_le_0_compat.
  - apply total_nonneg. intros i Hi. specialize (Hm i Hi). pose proof (Rle_0_sqr (v i t)) as Q. unfold Rsqr in Q. nra.
  - apply total_nonneg. intros e He. destruct (stores e He) as (_ & _ & H0 & _). apply H0, Hdom, He.
Qed.
End Machine.
